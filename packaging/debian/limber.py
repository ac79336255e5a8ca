#!/usr/bin/python3
from limber.cli.main import main

if __name__ == "__main__":  # the workers of limber sweep import it
    main()

#!/usr/bin/python3
from limber.cli.main import main

main()

"""`python -m limber` is the `limber` program."""

from limber.cli.main import main

main()

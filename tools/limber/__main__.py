"""`python -m limber` is the `limber` program."""

from limber.cli import main

main()

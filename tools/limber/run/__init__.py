"""Runs of a scenario: the processes of the stack, or all of it in one process; the demo."""

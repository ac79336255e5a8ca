"""Recorded logs: reading them, and the commands that print or convert them."""

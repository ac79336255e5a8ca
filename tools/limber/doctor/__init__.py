"""Whether this machine can run an arm."""

"""A robot as other simulators read it."""

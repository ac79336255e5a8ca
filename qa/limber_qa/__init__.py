"""For those who work on limber: machine check, tests, benchmarks."""

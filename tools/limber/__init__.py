"""limber's Python side: command line, runs, logs, plots and measurements."""

__version__ = "0.1.0"

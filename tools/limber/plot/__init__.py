"""Charts of a log, as PNG files and as an interactive page."""

"""A control law outside limber's tree: its first file, its compiler, its check."""

"""A log in the formats of other people's tools."""

"""`limber first-hour`: leads a person from the wires of an arm to its first soft push."""

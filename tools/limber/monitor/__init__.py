"""`limber monitor`: a running arm, or a recorded run, in the browser."""

"""`limber log replay`: a recorded log, sent again as LCM messages."""

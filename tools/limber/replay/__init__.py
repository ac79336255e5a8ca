"""`limber replay`: a recorded log, sent again as LCM messages."""

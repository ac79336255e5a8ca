"""What an arm really is, from logs of its runs: motors, friction, springs, weight, payload."""

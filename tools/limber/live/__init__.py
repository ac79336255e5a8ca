"""A running stack: its messages, a live view, requests to it, and the network they need."""

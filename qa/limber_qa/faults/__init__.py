"""The fault matrix: what may fail, what limber has to make of it, and whether it does."""

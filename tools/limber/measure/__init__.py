"""The numbers of a run, from its log alone, and whether they are within tolerance."""

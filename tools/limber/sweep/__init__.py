"""Many runs of one scenario with other values, on this machine or a cluster: `limber sweep`."""

"""Work beyond one machine: engines on clusters, and the check that all CPUs give equal bits."""

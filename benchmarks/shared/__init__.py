"""What several benchmarks share: ways to measure, missions, the floor's space, and the file of results."""

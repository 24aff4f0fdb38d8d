"""Statistics and comparisons of runs."""

"""The measures of tasks: pure functions and small counters over rows of robots."""

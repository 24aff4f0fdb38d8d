"""The measures of scenes: pure functions and small counters over rows of robots."""

"""The measures by which scenes tell success: pure functions and small counters over rows of robots."""

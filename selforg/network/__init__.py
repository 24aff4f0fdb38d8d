"""The behaviour network: conditions, activation, arbitration and plan, for rows of robots."""

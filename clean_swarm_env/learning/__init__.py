"""What a learner sees, does and gets, for rows of robots."""

"""What a robot observes, term by term."""

"""What changes in a network from step to step."""

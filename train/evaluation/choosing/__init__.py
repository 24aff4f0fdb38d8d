"""What choosing brings on a family: by the situation, by looking ahead, and by how often."""

"""What a network did and why, in data and in words."""

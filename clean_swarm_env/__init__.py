"""The cleaning world, its mission and its RL borders (knows selforg and selector)."""

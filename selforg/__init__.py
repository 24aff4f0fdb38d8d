"""Self-organisation for robots: gradients, mechanisms and the behaviour network (knows NumPy and Numba only)."""

"""Gradients, own poses and the buffer that keeps what robots have received."""

"""Runs in processes, and the directory that keeps them."""

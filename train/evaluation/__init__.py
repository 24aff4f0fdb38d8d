"""Evaluations of experiments and families, and their repetition."""

"""Evaluations of experiments and families, and repetition of their runs."""

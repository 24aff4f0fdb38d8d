"""Mechanisms: one short formula and one registered class each."""

"""Advice for a mission: which options its robots should hold, and whether to change them on the way pays."""

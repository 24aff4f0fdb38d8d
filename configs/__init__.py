"""Worlds, missions, mechanism configurations, expert knowledge and experiments, shipped as data."""

"""Missions, mechanism configurations, expert knowledge, start configurations and experiments, shipped as data."""

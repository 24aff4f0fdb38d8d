"""Planners of the unified-planning library behind the same interface."""

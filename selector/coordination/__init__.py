"""Coordinators: which configuration serves a goal now."""

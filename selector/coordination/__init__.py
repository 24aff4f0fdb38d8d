"""Coordinators, which run the configuration that serves a goal now, and the robots that have them."""

"""Mechanism configurations: their documents, and configurations at work in robots."""

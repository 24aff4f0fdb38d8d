"""Strategies that learn the value of options from rewards."""

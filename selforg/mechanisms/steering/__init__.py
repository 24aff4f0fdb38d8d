"""Steering mechanisms, which change what a movement commands instead of replacing it."""

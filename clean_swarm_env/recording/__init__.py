"""Recordings of missions: one format, written while a mission runs, and read as arrays and tables."""

"""Missions, experiments, families and start configurations as documents."""

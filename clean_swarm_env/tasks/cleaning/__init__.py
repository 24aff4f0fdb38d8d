"""Cleaning: the robot, garbage and what robots do with it, consequences of collisions, and the task."""

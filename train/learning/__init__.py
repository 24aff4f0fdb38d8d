"""Trainings: PPO on options and bandits."""

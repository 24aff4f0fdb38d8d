"""Trainings of policies by PPO and of bandits."""

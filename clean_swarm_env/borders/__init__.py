"""The environment as Gymnasium and Stable-Baselines3 want it."""

"""The environment by the interfaces of Gymnasium and Stable-Baselines3."""

"""Learning by PPO of Stable-Baselines3; imports torch."""

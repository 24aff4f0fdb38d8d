"""Deciders, which say in each decision period what robots do, and the texts that name them."""

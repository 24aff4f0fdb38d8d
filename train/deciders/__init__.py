"""Deciders: who says in each decision period what robots do, and how a text names them."""

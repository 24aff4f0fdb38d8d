"""Benchmarks of recordings and of the page that shows them."""

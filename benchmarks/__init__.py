"""Benchmarks of speed, each beside a reference; `make bench` runs all of them."""

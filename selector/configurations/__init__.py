"""Configurations of the library: documents and what runs of them."""

"""The compiled loops of the mechanisms."""

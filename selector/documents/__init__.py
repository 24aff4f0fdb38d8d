"""YAML documents: how they are found, read and checked, and the wording of errors."""

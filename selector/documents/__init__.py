"""YAML documents: reading, checking, one wording of errors."""

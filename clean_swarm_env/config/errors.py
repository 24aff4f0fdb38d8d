"""The error of all configuration files, by the name that this package and its users import."""

from selector.documents.errors import DocumentError

ConfigurationError = DocumentError
"""A configuration, a file or a name that cannot be used."""

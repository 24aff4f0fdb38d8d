"""The one error of all configuration files, under the name by which this package and its users know it."""

from selector.documents.errors import DocumentError

ConfigurationError = DocumentError
"""A configuration, a file or a name that cannot be used."""

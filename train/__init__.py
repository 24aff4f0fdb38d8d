"""Command line, evaluation, training and reports; imports all other packages."""

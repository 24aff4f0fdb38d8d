"""Command line, evaluation, training and reports (knows all)."""

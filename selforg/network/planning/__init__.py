"""The planning problem, the built-in search and what plans are watched for."""

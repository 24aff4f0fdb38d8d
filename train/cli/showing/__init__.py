"""Commands that show runs and results in files: pictures, videos, reports."""

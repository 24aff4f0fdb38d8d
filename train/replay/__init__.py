"""The replay page of recordings: one file that needs nothing else, see `page`."""

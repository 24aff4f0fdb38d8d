"""The page of a directory of results: tables, charts and links, in one file that needs no network."""

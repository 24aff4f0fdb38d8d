"""Releases: how one is built, what it froze, and files of each that later ones read (docs/versions.md)."""

"""Goals of the library, run on their scenes."""

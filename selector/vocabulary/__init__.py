"""Document models of the parts of robots and mechanism configurations."""

"""Studies: search for parameters of options by missions on training scenarios; a last race on fresh ones decides."""

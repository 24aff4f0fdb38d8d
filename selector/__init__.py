"""Which mechanism serves a self-organisation goal now (knows selforg)."""

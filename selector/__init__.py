"""Selection of the mechanism that serves a self-organisation goal; imports selforg."""

"""Bodies on a torus: motion, contacts, collisions."""

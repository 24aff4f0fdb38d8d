"""Walls: straight segments that bodies cannot cross, the free ground between them, and the ways round them."""

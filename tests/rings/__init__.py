"""The two rings of tests, the gate and the long one, and how long their files take."""

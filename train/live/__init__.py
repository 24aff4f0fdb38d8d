"""A mission that runs before the eyes of a person, who may change it by hand; `clean-swarm play`."""

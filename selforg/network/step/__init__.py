"""One step of the network, stage by stage."""

"""The command line `clean-swarm`; heavy libraries are imported by the commands that need them."""

from train.cli.app import main as main

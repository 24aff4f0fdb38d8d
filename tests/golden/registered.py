"""Which replayer takes which golden file: one line a file."""

from tests.golden import movement
from tests.golden.runner import REPLAYERS, replays

replays("movement.json", movement.replay)

FILES = tuple(REPLAYERS)

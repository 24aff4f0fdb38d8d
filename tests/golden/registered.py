"""Which replayer takes which golden file: one line a file."""

from tests.golden import buffer, conditions, movement, network
from tests.golden.runner import REPLAYERS, replays

replays("buffer.json", buffer.replay)
replays("conditions.json", conditions.replay)
replays("gradients.json", gradients.replay)
replays("movement.json", movement.replay)
replays("network.json", network.replay)

FILES = tuple(REPLAYERS)

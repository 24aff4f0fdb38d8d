"""Which replayer takes which golden file: one line a file."""

from tests.golden import buffer, conditions, decisions, gradients, monitoring, movement, network, selection
from tests.golden.runner import REPLAYERS, replays

replays("buffer.json", buffer.replay)
replays("conditions.json", conditions.replay)
replays("decisions.json", decisions.replay)
replays("gradients.json", gradients.replay)
replays("monitoring.json", monitoring.replay)
replays("movement.json", movement.replay)
replays("network.json", network.replay)
replays("selection.json", selection.replay)

FILES = tuple(REPLAYERS)

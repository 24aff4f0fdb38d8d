"""Which replayer takes which golden file: one line a file."""

from tests.golden import buffer, decisions, gradients, movement, selection
from tests.golden.network import conditions, monitoring, traces
from tests.golden.runner import REPLAYERS, replays

replays("buffer.json", buffer.replay)
replays("conditions.json", conditions.replay)
replays("decisions.json", decisions.replay)
replays("gradients.json", gradients.replay)
replays("monitoring.json", monitoring.replay)
replays("movement.json", movement.replay)
replays("network.json", traces.replay)
replays("selection.json", selection.replay)

FILES = tuple(REPLAYERS)

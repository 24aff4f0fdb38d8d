"""What a network can say about its last step, by name; for people and tests, not for the hot path."""

from __future__ import annotations

from selforg.network.model import packed as t
from selforg.network.model.packed import ints_of
from selforg.network.network import BehaviourNetwork

Wish = tuple[str, float]


def behaviour_wishes(network: BehaviourNetwork, row: int, behaviour: str) -> list[Wish]:
    """Return what a behaviour wished in the last step: (sensor, signed change wanted)."""
    return _wishes(network, row, network.model.behaviour_index[behaviour])


def goal_wishes(network: BehaviourNetwork, row: int, goal: str) -> list[Wish]:
    """Return what a goal wished in the last step: (sensor, signed change wanted)."""
    return _wishes(network, row, len(network.model.behaviours) + network.model.goal_index[goal])


def _wishes(network: BehaviourNetwork, row: int, owner: int) -> list[Wish]:
    ints, state, sensors = network.model.ints, network.state, network.model.sensors
    first, sensor = ints_of(ints, t.WISH_FIRST), ints_of(ints, t.WISH_SENSOR)
    mine = [u for u in range(first[owner], first[owner + 1]) if state.wish_kept[row, u]]
    return [(sensors[sensor[u]].name, float(state.wishes[row, u])) for u in mine]

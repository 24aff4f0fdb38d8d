"""The wishes of a network's last step by name, as the golden data list them."""

from __future__ import annotations

from selforg.network.network import BehaviourNetwork

Wish = tuple[str, float]


def behaviour_wishes(network: BehaviourNetwork, row: int, behaviour: str) -> list[Wish]:
    """Return the wishes of a behaviour in the last step: (sensor, signed change wanted)."""
    return _wishes(network, row, network.model.behaviour_index[behaviour])


def goal_wishes(network: BehaviourNetwork, row: int, goal: str) -> list[Wish]:
    """Return the wishes of a goal in the last step: (sensor, signed change wanted)."""
    return _wishes(network, row, len(network.model.behaviours) + network.model.goal_index[goal])


def _wishes(network: BehaviourNetwork, row: int, owner: int) -> list[Wish]:
    packed, state, sensors = network.model.packed.record, network.state, network.model.sensors
    mine = range(packed.wish_first[owner], packed.wish_first[owner + 1])
    kept = [u for u in mine if state.wish_kept[row, u]]
    return [(sensors[packed.wish_sensor[u]].name, float(state.wishes[row, u])) for u in kept]

"""What a cleaning robot believes of items: those that it sees and carries, put into the site of its mind."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from clean_swarm_env.robots.sensed import HANDLING, Sensed
from clean_swarm_env.tasks.cleaning.garbage import ABSENT, CARRIED, DONE, LYING, NOTHING
from clean_swarm_env.tasks.cleaning.task import Cleaning
from selector.documents.plain import must_fit
from selforg.network import state as st


def check_cargo(task: object) -> None:
    """Raise DocumentError for robots that need to know more of items than sensors and messages tell."""
    if isinstance(task, Cleaning):
        asks, finds = task.cargo_memory.tells or task.cargo_memory.handed is not None, task.site.packed.record.finders
        must_fit(not asks, "robot", "options that do not ask for its cargo (Transport)", "some that do")
        must_fit(not finds, "robot", "robots that carry items", "some that only find them for others")


def put_items(task: Cleaning, row: int, sensed: Sensed) -> None:
    """Let a robot believe what it has sensed of items and of its cargo; it knows nothing of other items."""
    garbage, seen, site = task.garbage, sensed.items, task.site
    count, room = garbage.stage.shape[1], int(site.packed.record.room[row])
    highest = max((*seen, *sensed.cargo), default=-1)
    must_fit(highest < count, "sensed: items and cargo", f"numbers below {count}", highest)
    must_fit(len(sensed.cargo) <= room, "sensed: cargo", f"at most {room} at a time (carries)", sensed.cargo)
    lay = {item: garbage.positions[0, item].copy() for item in np.flatnonzero(garbage.stage[0] == LYING).tolist()}
    places = {item: np.array(one[:2]) % task.world.ground.extent for item, one in seen.items()}
    had, emptied = garbage.load(row).tolist() if garbage.recycled[row] else [], not sensed.cargo
    gone = [item for item in lay if item not in seen or (places[item] != lay[item]).any()]
    come = [item for item in seen if item not in lay or item in gone]
    garbage.stage[0, [item for item in lay if item not in seen]] = ABSENT
    for item in seen:
        garbage.positions[0, item], garbage.stage[0, item] = places[item], LYING
        garbage.leftover[0, item] = seen[item].recycled
    dumped = [item for item in had if emptied and item not in seen]
    garbage.stage[0, dumped] = DONE
    garbage.done[0] += len(dumped)
    garbage.stage[0, list(sensed.cargo)] = CARRIED
    garbage.cargo[row], garbage.recycled[row] = (*sensed.cargo, NOTHING)[0], sensed.recycled
    for top, below in pairwise((*sensed.cargo, NOTHING)):
        garbage.under[0, top] = below
    if gone:
        site.hide_items(np.zeros(len(gone), dtype=np.int64), np.array([lay[item] for item in gone]))
    if come:
        site.show_items(0, np.array([places[item] for item in come]))


def handled(task: Cleaning, row: int) -> tuple[str, ...]:
    """Return what a robot begins to do with items, as it has just decided."""
    minds, several = task.movers.packed.record, task.site.packed.record.room[row] != 1
    layers = [st.EXECUTING if several and number == 0 else st.STARTED for number in range(len(HANDLING))]
    begun = (minds.marks[row, layer, one] for layer, one in zip(layers, minds.handling, strict=True))
    if task.standing[row]:
        return ()
    return tuple(name for name, marked in zip(HANDLING, begun, strict=True) if marked)

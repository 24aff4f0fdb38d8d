"""Changes of items that a person makes by hand; see `clean_swarm_env.world.by_hand`."""

from typing import Annotated

import numpy as np
from pydantic import Field

from clean_swarm_env.tasks.cleaning.garbage import ABSENT, LYING
from clean_swarm_env.tasks.cleaning.task import Cleaning
from clean_swarm_env.world.by_hand import WORLD, by_hand, free_place
from selector.documents.fields import Number

Item = Annotated[int, Field(strict=True, ge=0)]
"""Number of an item."""


@by_hand
def add_item(task: Cleaning, x: Number, y: Number) -> None:
    """Put a new item at a place [m]."""
    place = free_place(task.world, x, y)
    if not task.garbage.arrive(WORLD, place):
        raise ValueError(f"an item more: expected at most {task.garbage.stage.shape[1]} lying or carried")
    task.site.show_items(WORLD, place[None])


@by_hand
def put_item(task: Cleaning, item: Item, x: Number, y: Number) -> None:
    """Put an item that lies at another place [m]."""
    place = free_place(task.world, x, y)
    _lift(task, item)
    task.garbage.positions[WORLD, item] = place
    task.garbage.stage[WORLD, item] = LYING
    task.garbage.found[WORLD, item] = 0
    task.site.show_items(WORLD, place[None])


@by_hand
def remove_item(task: Cleaning, item: Item) -> None:
    """Take an item that lies away, as if it had never come."""
    _lift(task, item)
    task.garbage.arrived[WORLD] -= 1


def _lift(task: Cleaning, item: int) -> None:
    """Take an item from where it lies, so that robots no longer see it; ValueError if none lies there."""
    garbage = task.garbage
    if item >= garbage.stage.shape[1] or garbage.stage[WORLD, item] != LYING:
        raise ValueError(f"item {item}: expected an item that lies")
    place = garbage.positions[WORLD, [item]]
    garbage.stage[WORLD, item] = ABSENT
    task.site.hide_items(np.array([WORLD]), place)

"""Phases of a robot's task, by names and by numbers."""

from typing import Literal, get_args

Phase = Literal["patrol", "approach", "to_recycling", "to_dump"]
PHASES: tuple[Phase, ...] = get_args(Phase)
"""In the order of their numbers: no item in sight, an item in sight, with cargo, with recycled cargo."""
PATROL, APPROACH, TO_RECYCLING, TO_DUMP = range(4)

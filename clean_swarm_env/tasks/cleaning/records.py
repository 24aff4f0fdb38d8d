"""The two records of a tick: the floor with bodies, items and stations, and what the robots know and decide.

Shapes: W worlds, N robots a world, R = W * N rows, M items and K stations a world, S sensors, B behaviours of the
robots' network.
"""

from typing import Annotated, NamedTuple

from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.records import opening


class FloorRecord(NamedTuple):
    """Bodies, items and stations on the floor; owned by `Site`."""

    robots: Annotated[Floats, "R 2", READ]  # positions [m]
    headings: Annotated[Floats, "R", READ]  # [rad]
    extent: Annotated[Floats, "2", READ]  # of the torus [m]
    longest: float  # half its diagonal [m]
    stations: Annotated[Floats, "W K 2", READ]  # [m]
    kinds: Annotated[Ints, "K", READ]  # RECYCLING or DUMP
    items: Annotated[Floats, "W M 2", KEPT]  # where each item lies or was picked [m]
    stage: Annotated[Ints, "W M", KEPT]  # LYING, CARRIED, DONE or ABSENT
    leftover: Annotated[Ints, "W M", KEPT]  # 1 where what lies has been recycled already
    under: Annotated[Ints, "W M", KEPT]  # the item below a carried one in its load, or NOTHING
    found: Annotated[Ints, "W M", KEPT]  # ticks for which robots that carry nothing know the item
    cargo: Annotated[Ints, "R", KEPT]  # the item on top of what a robot carries, or NOTHING
    recycled: Annotated[Ints, "R", KEPT]  # 1 once the cargo has been recycled
    leg: Annotated[Floats, "R", KEPT]  # way to the next station from where the cargo was picked or recycled [m]
    blind: Annotated[Ints, "R", KEPT]  # ticks for which a robot sees no item that lies
    done: Annotated[Ints, "W", KEPT]  # items dumped
    nearest: Annotated[Ints, "R", SCRATCH]  # the nearest item when the robot last sensed; NOTHING where none is near
    picked: Annotated[Ints, "R 2", SCRATCH]  # row and item of what was picked in this tick, the first ones
    standing: Annotated[Ints, "R", READ]  # ticks for which a robot stands after a collision; see `consequences`
    phases: Annotated[Ints, "R", SCRATCH]  # the robot's phase when it was last observed; see `learning.around.PHASES`
    in_sight: Annotated[Ints, "R", SCRATCH]  # the nearest item that it saw then, -1 without one
    station_ways: Annotated[Floats, "R 2 3", SCRATCH]  # the ways to the nearest recycling and dump, by `longest`
    nearness: Annotated[Floats, "R 2", SCRATCH]  # how near these were: 1 at a station, 0 where `near` ends
    lying: Annotated[Flags, "M", SCRATCH]  # scratch: items of one world that lie
    cells: Annotated[Ints, "lines columns", SCRATCH]  # scratch: see `physics.cells`
    links: Annotated[Ints, "M", SCRATCH]  # scratch: see `physics.cells`
    walled: int  # whether there are walls
    hidden: int  # whether robots see no items behind them
    sight: Annotated[Floats, "R", READ]  # distance up to which the robot sees items [m]
    found_again: int  # ticks after which such robots find it once more
    room: Annotated[Ints, "R", READ]  # items that the robot carries at a time; 0: it only finds them
    finders: int  # 1 if any robot only finds items
    at_item: float  # distance up to which a robot is at an item [m]
    at_station: float  # distance up to which a robot is at a station [m]
    pick_distance: float  # distance up to which an item is picked [m]


class MindsRecord(NamedTuple):
    """What robots read and decide, and which behaviours move them; owned by `Movers`."""

    readings: Annotated[Floats, "R S", KEPT]  # of the network
    marks: Annotated[Ints, "R LAYERS B", READ]  # of the network
    handling: Annotated[Ints, "3", READ]  # behaviours that pick, recycle and dump
    transport: Annotated[Ints, "2", READ]  # behaviours that go to stations of kind RECYCLING and DUMP
    movers: Annotated[Ints, "L", READ]  # behaviours that follow a mechanism by themselves
    starting: Annotated[Flags, "R 3", SCRATCH]  # robots that pick, recycle and dump in this tick
    running: Annotated[Ints, "L R", SCRATCH]  # rows in which each mover runs, the first `counts` of them
    counts: Annotated[Ints, "L", SCRATCH]


open_floor, open_minds = opening(FloorRecord), opening(MindsRecord)

"""The records of gradients and poses that compiled code takes; columns of tables are in `columns`.

Letters of shapes: R rows, K poses of a row, T teams, S information spaces, C channels, M gradients that fit in, B
buckets (a power of two), P pairs, L levels.
"""

from typing import Annotated, NamedTuple

from selforg.arrays import KEPT, READ, SCRATCH, Floats, Ints, Links, Octets, clocked
from selforg.compiler.records import opening
from selforg.gradients.store.columns import POSE_STAMP

MOST_CANDIDATES = 512  # gradients that are looked at together

Margins = tuple[float, float, float]
"""How far beyond its reach a gradient is seen [m], for attraction -1, 0, +1; negative infinity: not looked at."""


class Poses(NamedTuple):
    """The poses that rows share, and cells by which those of large teams are found."""

    own: Annotated[Floats, "R K POSE", clocked(POSE_STAMP)]  # poses of each row, the newest first; columns POSE_
    rows: Annotated[Ints, "R ROW", KEPT]  # columns ROW_
    teams: Annotated[Ints, "R", READ]  # of each row
    first: Annotated[Ints, "T+1", READ]  # where each team begins in `members`
    members: Annotated[Ints, "R", READ]  # rows, team by team
    reach: Annotated[Floats, "T", SCRATCH]  # largest reach of a pose in each team [m]
    extent: Annotated[Floats, "3", READ]  # of the space [m], 0 for an open axis
    cells: Annotated[Floats, "1 CELL", READ]  # one grid for all teams; columns of `selforg.grid`
    buckets: Annotated[Links, "B", SCRATCH]  # first row in each bucket, -1 for none
    links: Annotated[Links, "R 2", SCRATCH]  # next row in the bucket, -1 for none; cell of the row
    radii: Annotated[Floats, "R 2", READ]  # diffusion and goal radius of the poses that rows spread from now on [m]
    wall_ways: Annotated[Floats, "R S 2", SCRATCH]  # ways to the nearest points of near walls [m]; S is 0 without walls
    wall_counts: Annotated[Ints, "R", SCRATCH]  # how many there are
    segments: Annotated[Floats, "K 4", READ]  # this and the next fields: those of `Walls`
    cell_lists: Annotated[Ints, "CELLS", READ]
    listed: Annotated[Ints, "L", READ]
    clear: Annotated[Floats, "CELLS", READ]
    wall_grid: Annotated[Floats, "6", READ]  # left, bottom, pitch, near, columns, lines
    room: Annotated[
        Octets, "lines columns", READ
    ]  # this and the next fields: those of `Ways` and `Aims`; none: 0 targets
    pitch: Annotated[Floats, "2", READ]
    corner: Annotated[Floats, "2", READ]
    aims: Annotated[Ints, "T M", READ]
    aim_squares: Annotated[Ints, "F 2", READ]
    fields: Annotated[Links, "F lines columns", READ]
    attraction: float  # of these, -1, 0 or +1
    history: int  # poses remembered of each row


class Store(NamedTuple):
    """The gradients of a buffer, and memory for what searches find."""

    near: Annotated[Floats, "M NEAR", KEPT]  # columns X .. GOAL_RADIUS and NEAR_
    links: Annotated[Links, "M LINK", KEPT]  # columns LINK_
    far: Annotated[Floats, "M FAR", KEPT]  # columns FAR_
    marks: Annotated[Links, "M MARK", KEPT]  # columns MARK_
    layers: Annotated[Links, "C*S*L LAYER", KEPT]  # columns LAYER_
    buckets: Annotated[Links, "B", KEPT]  # first slot in each bucket of cells, -1 for none
    rules: Annotated[Ints, "C", READ]  # aggregation rule of each channel, AGGREGATE_
    bounds: Annotated[Floats, "L", READ]  # largest reach in each level [m]
    cells: Annotated[Floats, "L CELL", READ]  # grid of each level; columns of `selforg.grid`
    counters: Annotated[Ints, "COUNTERS", KEPT]  # entries COUNTER_
    extent: Annotated[Floats, "3", READ]  # of the space [m], 0 for an open axis
    window: Annotated[Ints, "MOST_CELLS", SCRATCH]  # room for the cells around a place
    candidates: Annotated[Ints, "MOST_CANDIDATES", SCRATCH]  # room for the slots that lie there
    chosen: Annotated[Ints, "MOST_CANDIDATES", SCRATCH]  # room for the indices of some candidates
    offsets_x: Annotated[Floats, "MOST_CANDIDATES", SCRATCH]  # room for the offset to each candidate [m]
    offsets_y: Annotated[Floats, "MOST_CANDIDATES", SCRATCH]
    offsets_z: Annotated[Floats, "MOST_CANDIDATES", SCRATCH]
    reaches: Annotated[Floats, "MOST_CANDIDATES", SCRATCH]  # room for how far each candidate is seen [m]
    distances: Annotated[Floats, "MOST_CANDIDATES", SCRATCH]  # room for the distance of each candidate [m]
    spaces: int  # S: information spaces, of a team or of a row each
    per_row: int  # 1 if every row has a space of its own
    aggregation_distance: float  # static gradients closer than this aggregate [m]
    min_diffusion: float  # a gradient without goal area and with less diffusion than this is deleted [m]
    whole_seconds: int  # 1: evaporation counts whole seconds, as the original does (Q3)
    history: int  # moving gradients kept per channel and source
    hidden: int  # 1: gradients behind walls are not seen


class Sight(NamedTuple):
    """The channels at which rows look, and room for what they see there."""

    channels: Annotated[Ints, "C+1", READ]  # first 1 if the shared poses are looked at, then codes of channels
    known: int  # channels that the buffer knew then; with more of them these codes may be others
    pairs: Annotated[Floats, "P PAIR", SCRATCH]  # columns PAIR_


class Look(NamedTuple):
    """What one row looks at once; made and passed on in compiled code only."""

    row: int
    first: int  # pair from which on what the row sees is written
    limit: int  # number of pairs at which looking ends; one more than there is room for: all are counted
    now: float  # [s]
    sight_bits: int  # what is looked at: SEE_STATIC, SEE_MOVING, ...
    margins: Margins
    x: float  # where the row is [m]
    y: float
    z: float


class Left(NamedTuple):
    """One kind of gradient that rows leave behind, with room for who leaves it, when and where."""

    message: Annotated[Floats, "1 MESSAGE", SCRATCH]
    tag: Annotated[Ints, "1 TAG", SCRATCH]


open_poses, open_store, open_sight, open_left = opening(Poses), opening(Store), opening(Sight), opening(Left)

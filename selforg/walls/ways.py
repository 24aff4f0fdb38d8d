"""Ways round walls: for each target a field of distances over the raster of the free ground, down which robots go.

A field is computed when a target is first asked for, and kept: walls do not move, so that all worlds of a batch share
it. Robots to which the straight way is open go straight. Lengths in the field are counted in fifths of a square.
"""

from typing import Annotated, Final

import numpy as np

from selforg.arrays import OUTSIDE, READ, SCRATCH, Floats, Ints, Links, Octets, derived
from selforg.compiler.decorators import inlined, lean_kernel, part
from selforg.space import nearest_image
from selforg.walls.free_ground import FreeGround, neighbour

STRAIGHT_STEP, DIAGONAL_STEP = 5, 7  # lengths of a step
TIGHT: Final = 3  # factor on a step beside a wall, and [squares] how wide that is
UNREACHED: Final = -1
RING_OF_LENGTHS: Final = 32
"""Buckets of lengths; no step is so long."""
LATTICE: Final = 16
"""Squares between the places to which items that lie about them share a field."""
LOOKS: Final = (5, 5, 6)  # squares of the way after which a robot that looks ahead looks whether they are open
MOST_ROOM: Final = 255
RASTER_SLACK: Final = 4  # squares up to which the raster may be off by
MOST_FIELD_BYTES: Final = 1 << 26
"""Memory for all fields, of which the first is given up for a new one; there are eight in any case."""
NO_FIELD: Final = -1
UNKNOWN: Final = -2


class Ways:
    """The ways to targets on a free ground.

    Attributes:
        corner: (2,) lower left corner of the ground; places are given from there [m].
        room: (lines, columns) squares from each one to the nearest one on which there is none; 0: there is none here.
        extent: (2,) of the space, 0 for an axis that is open [m].
        pitch: (2,) sides of a square [m].
        numbers: (lines, columns) number of the field of each square that is a target, NO_FIELD for the others.
        fields: (F, lines, columns) lengths of the ways to targets, UNREACHED where there is none.
        queue: (3, squares) room for `fill_field`.

    """

    room: Annotated[Octets, "lines columns", READ]
    corner: Annotated[Floats, "2", READ]
    extent: Annotated[Floats, "2", READ]
    pitch: Annotated[Floats, "2", READ]
    numbers: Annotated[Ints, "lines columns", OUTSIDE]  # what fields hold follows from the walls alone
    fields: Annotated[Links, "F lines columns", OUTSIDE]
    queue: Annotated[Links, "3 squares", SCRATCH]

    def __init__(self, ground: FreeGround, closed: bool) -> None:
        lines, columns = ground.regions.shape
        size = ground.high - ground.low
        self.corner = ground.low
        self.extent = size.copy() if closed else np.zeros(2)
        self.pitch = size / (columns, lines)
        self.room = np.zeros((lines, columns), np.uint8)
        measure_room(ground.regions, ground.main, closed, self.room)
        self.numbers = np.full((lines, columns), NO_FIELD)
        self.fields = np.zeros((0, lines, columns), np.int32)
        self._targets: list[tuple[int, int]] = []
        self.queue = np.zeros((3, max(lines * columns, RING_OF_LENGTHS)), np.int32)

    def add(self, line: int, column: int) -> None:
        """Compute the field of a target in a square, in place of the oldest one if there is no more memory."""
        most = max(MOST_FIELD_BYTES // max(self.room.size * 4, 1), 8)
        number = len(self._targets) % most
        if len(self._targets) >= most:
            self.numbers[self._targets[-most]] = NO_FIELD
        elif number == len(self.fields):
            more = np.zeros((min(2 * number + 4, most), *self.room.shape), np.int32)
            more[:number] = self.fields
            self.fields = more
        self._targets.append((line, column))
        fill_field(line, column, self.extent[0] > 0.0, self.room, self.fields[number], self.queue)
        self.numbers[line, column] = number


class Aims:
    """Fields of targets that stay where they are, K in each of W worlds; targets in one square share a field.

    Attributes:
        numbers: (W, K) number of the field of each target, UNKNOWN until `renew`.
        squares: (F, 2) line and column of the target of each field, -1 for a field without one.
        fields: (F, lines, columns) see `Ways`.

    """

    numbers: Annotated[Ints, "W K", derived(UNKNOWN)]
    squares: Annotated[Ints, "F 2", OUTSIDE]  # what fields hold follows from walls and targets
    fields: Annotated[Links, "F lines columns", OUTSIDE]

    def __init__(self, ways: Ways, worlds: int, targets: int) -> None:
        self._ways = ways
        self.numbers = np.full((worlds, targets), UNKNOWN)
        self.squares = np.zeros((0, 2), np.int64)
        self.fields = np.zeros((0, *ways.room.shape), np.int32)

    def renew(self, places: Floats) -> None:
        """Compute the fields of targets at `places` (W, K, 2) [m] that are UNKNOWN."""
        ways = self._ways
        for world, target in np.argwhere(self.numbers == UNKNOWN).tolist():
            x, y = (places[world, target] - ways.corner).tolist()
            line, column = square_of(x, y, ways.room, ways.pitch)
            square = np.array([line, column])
            known = np.flatnonzero((self.squares == square).all(axis=1))
            if not len(known):
                known = np.setdiff1d(np.arange(len(self.squares)), self.numbers)  # of no target any more
            if not len(known):
                known = np.array([len(self.squares)])
                more = max(len(self.squares), 1)
                self.squares = np.concatenate([self.squares, np.full((more, 2), -1)])
                self.fields = np.concatenate([self.fields, np.zeros((more, *ways.room.shape), np.int32)])
            number = int(known[0])
            if (self.squares[number] != square).any():
                self.squares[number] = square
                fill_field(line, column, ways.extent[0] > 0.0, ways.room, self.fields[number], ways.queue)
            self.numbers[world, target] = number


@lean_kernel
def measure_room(regions: Ints, main: int, closed: bool, room: Octets) -> None:
    """Write for each square how many squares, diagonals included, the nearest one outside of the region `main` is away.

    One sweep forwards and one backwards are enough; on a torus (`closed`) each is run twice, over its seams.
    """
    lines, columns = regions.shape
    for line in range(lines):
        for column in range(columns):
            room[line, column] = MOST_ROOM if regions[line, column] == main else 0
    for sweep in range(4 if closed else 2):
        forwards = sweep % 2 == 0
        for k in range(lines * columns):
            square = k if forwards else lines * columns - 1 - k
            line, column, least = square // columns, square % columns, MOST_ROOM
            for walk in range(9):
                i, j = neighbour(line, column, walk, lines, columns, closed)
                if i < 0:
                    least = min(least, 1)
                elif i != line or j != column:
                    least = min(least, room[i, j] + 1)
            if least < room[line, column]:
                room[line, column] = least


@lean_kernel
def fill_field(line: int, column: int, closed: bool, room: Octets, field: Links, queue: Links) -> None:
    """Write the lengths of the ways from all squares to one into `field` (lines, columns).

    Dijkstra's algorithm with a ring of buckets by length (Dial 1969, doi:10.1145/363269.363610), since no step is
    as long as the ring. queue: (3, squares or more) the next and the last square in the bucket of each one, and the
    first square of each bucket.
    """
    lines, columns = room.shape
    follows, precedes, firsts = queue[0], queue[1], queue[2]
    for k in range(lines * columns):
        field[k // columns, k % columns] = UNREACHED
    for bucket in range(RING_OF_LENGTHS):
        firsts[bucket] = UNREACHED
    field[line, column] = 0
    put_square(line * columns + column, 0, follows, precedes, firsts)
    waiting, length = 1, 0
    while waiting > 0:
        here = firsts[length % RING_OF_LENGTHS]
        if here == UNREACHED:
            length += 1
            continue
        drop_square(here, length, follows, precedes, firsts)
        waiting -= 1
        line, column = here // columns, here % columns
        for walk in range(9):
            i, j = neighbour(line, column, walk, lines, columns, closed)
            if i < 0 or room[i, j] == 0:
                continue
            step = DIAGONAL_STEP if walk // 3 != 1 and walk % 3 != 1 else STRAIGHT_STEP
            way = length + (TIGHT * step if room[i, j] <= TIGHT else step)
            before = field[i, j]
            if before == UNREACHED or way < before:
                if before != UNREACHED:
                    drop_square(i * columns + j, before, follows, precedes, firsts)
                    waiting -= 1
                field[i, j] = way
                put_square(i * columns + j, way, follows, precedes, firsts)
                waiting += 1


@inlined
def put_square(square: int, length: int, follows: Links, precedes: Links, firsts: Links) -> None:
    """Put a square into the bucket of its length."""
    first = firsts[length % RING_OF_LENGTHS]
    follows[square], precedes[square] = first, UNREACHED
    if first != UNREACHED:
        precedes[first] = square
    firsts[length % RING_OF_LENGTHS] = square


@inlined
def drop_square(square: int, length: int, follows: Links, precedes: Links, firsts: Links) -> None:
    """Take a square out of the bucket of its length."""
    after, before = follows[square], precedes[square]
    if before == UNREACHED:
        firsts[length % RING_OF_LENGTHS] = after
    else:
        follows[before] = after
    if after != UNREACHED:
        precedes[after] = before


@part
def square_of(x: float, y: float, room: Octets, pitch: Floats) -> tuple[int, int]:
    """Return line and column of the square in which a robot at a place [m] is, the nearest one that has room."""
    lines, columns = room.shape
    line = min(max(int(np.floor(y / pitch[1])), 0), lines - 1)
    column = min(max(int(np.floor(x / pitch[0])), 0), columns - 1)
    if room[line, column] > 0:
        return line, column
    best, found_line, found_column = np.inf, line, column
    for i in range(max(line - RASTER_SLACK, 0), min(line + RASTER_SLACK + 1, lines)):
        for j in range(max(column - RASTER_SLACK, 0), min(column + RASTER_SLACK + 1, columns)):
            dx, dy = (j + 0.5) * pitch[0] - x, (i + 0.5) * pitch[1] - y
            if room[i, j] > 0 and dx * dx + dy * dy < best:
                best, found_line, found_column = dx * dx + dy * dy, i, j
    return found_line, found_column


@part
def shared_square(x: float, y: float, room: Octets, pitch: Floats, extent: Floats) -> tuple[int, int]:
    """Return the square of the nearest place of the lattice that is open straight from a target [m], else its own.

    So many targets share few fields: whoever has come so far sees the rest of the way.
    """
    lines, columns = room.shape
    line, column = square_of(x, y, room, pitch)
    best, found_line, found_column = np.inf, line, column
    for walk in range(4):
        i, j = (line // LATTICE + walk // 2) * LATTICE, (column // LATTICE + walk % 2) * LATTICE
        if i < lines and j < columns and room[i, j] > 0:
            dx, dy = (j + 0.5) * pitch[0] - x, (i + 0.5) * pitch[1] - y
            if dx * dx + dy * dy < best and is_open(x, y, dx, dy, room, pitch, extent):
                best, found_line, found_column = dx * dx + dy * dy, i, j
    return found_line, found_column


@part
def is_open(x: float, y: float, dx: float, dy: float, room: Octets, pitch: Floats, extent: Floats) -> bool:
    """Return whether a robot can go straight from (x, y) along (dx, dy) [m]; it may touch a wall at both ends.

    It looks from square to square, and skips those that have room around.
    """
    lines, columns = room.shape
    length, side = np.sqrt(dx * dx + dy * dy), min(pitch[0], pitch[1])
    beside = RASTER_SLACK * side
    gone = beside
    while gone < length - beside:
        share = gone / length
        line = int(np.floor((y + share * dy) / pitch[1]))
        column = int(np.floor((x + share * dx) / pitch[0]))
        outside = not (0 <= line < lines and 0 <= column < columns)
        if outside and extent[0] > 0.0:
            line, column, outside = line % lines, column % columns, False
        free = 1 if outside else room[line, column]  # open land has no walls outside of the raster
        if free == 0:
            return False
        gone += side * max(free - 1.0, 0.6)
    return True


@part
def way_down(x: float, y: float, field: Links, room: Octets, pitch: Floats, extent: Floats) -> tuple[float, float]:
    """Return the way [m] from a place to one of the next LOOKS squares down a field, the farthest that is open."""
    lines, columns = room.shape
    line, column = square_of(x, y, room, pitch)
    wx, wy = (column + 0.5) * pitch[0] - x, (line + 0.5) * pitch[1] - y
    found_x, found_y = wx, wy
    for look in LOOKS:
        for _ in range(look):
            best, down, right = field[line, column], 0, 0
            for walk in range(9):
                i, j = neighbour(line, column, walk, lines, columns, extent[0] != 0.0)
                if i >= 0 and 0 <= field[i, j] < best:
                    best, down, right = field[i, j], walk // 3 - 1, walk % 3 - 1
            line, column = (line + down) % lines, (column + right) % columns
            wx, wy = wx + right * pitch[0], wy + down * pitch[1]
        if look != LOOKS[0] and not is_open(x, y, wx, wy, room, pitch, extent):
            break
        found_x, found_y = wx, wy
    return found_x, found_y


@part
def to_target(
    x: float, y: float, tx: float, ty: float, extent: Floats, room: Octets, pitch: Floats
) -> tuple[float, float, bool]:
    """Return the shortest offset [m] to a target, and whether the straight way there is open."""
    dx, dy = nearest_image(tx - x, extent[0]), nearest_image(ty - y, extent[1])
    return dx, dy, is_open(x, y, dx, dy, room, pitch, extent)

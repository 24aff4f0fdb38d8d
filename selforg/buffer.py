"""SoBuffer: the gradients that robots have received, stored so that near ones are found without the rest."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from selforg.arrays import Floats, Ints, Links
from selforg.cells import make_grid, rebuild
from selforg.columns import (
    AGGREGATION_DISTANCE,
    ATTRACTION,
    CHANNELS,
    CLOCK,
    COUNT,
    COUNTERS,
    DIFFUSION,
    DUE,
    FACTOR,
    FREE,
    GOAL,
    GRADIENT_COLUMNS,
    HISTORY,
    HX,
    LAST_SERIAL,
    LAYER,
    LAYER_COLUMNS,
    LEVELS,
    LINK_COLUMNS,
    MIN_DIFFUSION,
    MOVING,
    PERIOD,
    SERIAL,
    SETTINGS,
    SLOT,
    SOURCE,
    SPACES,
    STAMP,
    TAG_CHANNEL,
    TAG_COLUMNS,
    TAG_MOVING,
    TAG_SIGN,
    TAG_SOURCE,
    TAG_SPACE,
    USED,
    WHOLE_SECONDS,
    X,
)
from selforg.gathering import Store
from selforg.gradient import Gradient, check_fields, check_gradient
from selforg.poses import OwnPoses
from selforg.settings import BufferSettings
from selforg.space import Space
from selforg.storing import clear_space, deposit_rows, evaporate_space, store_rows
from selforg.windows import MOST_CELLS

SMALLEST_CAPACITY = 64  # gradients


class SoBuffer:
    """Static and moving gradients of all teams; what one team stores, no other sees.

    The tables are owned here and changed by compiled code only; they double when they are full.

    Example:
        >>> space = Torus(11.0, 11.0)
        >>> poses = OwnPoses(space, rows=1)
        >>> buffer = SoBuffer(BufferSettings(aggregation_distance=0.1), space, poses)
        >>> buffer.store(Gradient("garbage", (2.0, 3.0), stamp=0.0), now=0.0)
    """

    def __init__(self, settings: BufferSettings, space: Space, poses: OwnPoses) -> None:
        if space is not poses.space:
            raise ValueError("SoBuffer: the poses live in another space object than the buffer")
        self.settings = settings
        self.space = space
        self.poses = poses
        self.spaces = poses.team_count
        self.channel_names: list[str] = []
        self._channel_codes: dict[str, int] = {}
        self._source_codes: dict[str, int] = {}
        self._source_names: list[str] = []
        self._payloads: dict[int, Mapping[str, Any]] = {}
        self.rules: Ints = np.zeros(0, dtype=np.int64)  # aggregation rule of each channel
        self._numbers: Floats = np.zeros((SMALLEST_CAPACITY, GRADIENT_COLUMNS))
        self._links: Links = np.full((SMALLEST_CAPACITY, LINK_COLUMNS), -1, dtype=np.int32)
        self._layers: Links = np.zeros((0, LAYER_COLUMNS), dtype=np.int32)
        self._buckets: Links = np.full(SMALLEST_CAPACITY, -1, dtype=np.int32)
        self._counters: Ints = np.zeros(COUNTERS, dtype=np.int64)
        self._counters[FREE] = -1
        self._counters[SPACES] = self.spaces
        self._limits: Floats = np.zeros(SETTINGS)
        self._limits[AGGREGATION_DISTANCE] = settings.aggregation_distance
        self._limits[MIN_DIFFUSION] = settings.min_diffusion
        self._limits[WHOLE_SECONDS] = float(settings.whole_seconds)
        self._limits[HISTORY] = settings.moving_storage_size
        self._grid = make_grid(space.padded_extent, space.dim, settings.smallest_cell)
        self._window: Ints = np.zeros(MOST_CELLS, dtype=np.int64)
        self.tables: Store = self._tables()

    def __len__(self) -> int:
        """Return how many gradients are stored, of all teams; those that evaporated unseen may still be counted."""
        return int(self._counters[USED])

    def store_static(
        self,
        teams: npt.ArrayLike,
        channel: str,
        positions: npt.ArrayLike,
        now: float,
        *,
        attraction: npt.ArrayLike = 1,
        diffusion: npt.ArrayLike = 1.0,
        goal_radius: npt.ArrayLike = 0.0,
        evaporation_factor: npt.ArrayLike = 1.0,
        evaporation_period: npt.ArrayLike = 0.0,
        source: npt.ArrayLike = -1,
    ) -> None:
        """Store one static gradient at each of `positions` (M, D) [m], in their order, at time `now` [s].

        teams and all fields: one value, or one for each (M,). Raises ValueError naming the field that is impossible.
        """
        places = np.atleast_2d(np.asarray(positions, dtype=np.float64))
        if places.shape[1:] != (self.space.dim,):
            raise ValueError(f"store_static: positions must be (M, {self.space.dim}), got {np.shape(positions)}")
        check_fields(places, attraction, diffusion, goal_radius, evaporation_factor, evaporation_period, now)
        if not self.keeps(channel):
            return
        messages, tags = self._messages(len(places))
        messages[:, X : X + self.space.dim] = self.space.wrap(places)
        messages[:, DIFFUSION], messages[:, GOAL] = diffusion, goal_radius
        messages[:, FACTOR], messages[:, PERIOD] = evaporation_factor, evaporation_period
        messages[:, STAMP] = messages[:, CLOCK] = now
        tags[:, TAG_SPACE], tags[:, TAG_CHANNEL] = self._check_teams(teams), self.channel_code(channel)
        tags[:, TAG_SOURCE], tags[:, TAG_SIGN] = source, attraction
        self._store(messages, tags, now)

    def extinguish(self, teams: npt.ArrayLike, channel: str, positions: npt.ArrayLike, now: float) -> None:
        """Delete the nearest static gradient at each of `positions` (M, D) by spreading one that is gone at once.

        It takes the place of the stored one because the channel aggregates by `new`; any other rule is an error.
        """
        rule = self.settings.aggregation.get(channel, self.settings.aggregation.get("DEFAULT"))
        if rule != "new":
            raise ValueError(f"extinguish: channel {channel!r} must aggregate by 'new', its rule is {rule!r}")
        self.store_static(teams, channel, positions, now, diffusion=0.0, goal_radius=0.0, attraction=0)

    def store(self, gradient: Gradient, now: float, *, team: int = 0) -> None:
        """Store one gradient that a team received at `now` [s]; raises ValueError naming a field that is impossible."""
        g = gradient
        place, heading = check_gradient(gradient, self.space.dim)
        if not self.keeps(g.channel):
            return
        messages, tags = self._messages(1)
        messages[0, X : X + self.space.dim] = self.space.wrap(place[: self.space.dim])
        messages[0, DIFFUSION], messages[0, GOAL] = g.diffusion, g.goal_radius
        messages[0, FACTOR], messages[0, PERIOD] = g.evaporation_factor, g.evaporation_period
        messages[0, STAMP], messages[0, CLOCK] = g.stamp, g.stamp if g.clock is None else g.clock
        messages[0, HX : HX + 3] = heading
        tags[0, TAG_SPACE], tags[0, TAG_CHANNEL] = self._check_teams(team), self.channel_code(g.channel)
        tags[0, TAG_SOURCE], tags[0, TAG_SIGN] = self.source_code(g.source), g.attraction
        tags[0, TAG_MOVING] = g.moving
        if g.payload:
            self._payloads[int(self._counters[LAST_SERIAL]) + 1] = g.payload
        self._store(messages, tags, now)

    def receive(self, gradient: Gradient, now: float, *, row: int) -> None:
        """Store one gradient that a row received at `now` [s]; the row's own pose gradient becomes its pose."""
        own = self.source_code(gradient.source) == row
        if not (own and gradient.moving and gradient.channel == self.poses.channel):
            self.store(gradient, now, team=int(self.poses.teams[row]))
            return
        check_gradient(gradient, self.space.dim)
        self.poses.set_pose(
            row, gradient.position, gradient.heading, gradient.stamp, diffusion=gradient.diffusion,
            goal_radius=gradient.goal_radius, attraction=gradient.attraction,
        )  # fmt: skip

    def deposit(self, rows: Ints, message: Floats, tag: Ints, now: float) -> None:
        """Store a copy of `message` (GRADIENT_COLUMNS,), `tag` (TAG_COLUMNS,) at the own pose of each of `rows` (R,)."""
        self._reserve(len(rows))
        deposit_rows(rows, message, tag, self.rules, now, self.poses.tables, self.tables)

    def clear(self, team: int) -> None:
        """Delete everything one team has stored."""
        clear_space(int(self._check_teams(team)), self.tables)

    def evaporate(self, now: float) -> None:
        """Bring everything to `now` [s] and free what evaporated away. Needed by hand only to free memory."""
        for space in range(self.spaces):
            evaporate_space(space, float(now), self.tables)

    def count(self, team: int, channel: str) -> int:
        """Return how many gradients of `channel` a team has stored; see `__len__`."""
        if channel not in self._channel_codes:
            return 0
        first = (self._channel_codes[channel] * self.spaces + team) * LEVELS
        return int(self._layers[first : first + LEVELS, COUNT].sum())

    def gradient_of(self, pair: Floats, now: float) -> Gradient:
        """Return the gradient of one pair (PAIR_COLUMNS,) as seen at `now` [s]; `clock` is when it last evaporated."""
        slot, dim = int(pair[SLOT]), self.space.dim
        if slot < 0:
            return self.poses.gradient(*divmod(-1 - slot, self.poses.rows)[::-1])
        fields, link = self._numbers[slot], self._links[slot]
        clock = fields[CLOCK]
        if np.isfinite(fields[DUE]):
            clock = fields[DUE] - fields[PERIOD]
        channel = int(link[LAYER]) // (LEVELS * self.spaces)
        return Gradient(
            channel=self.channel_names[channel],
            position=tuple(fields[X : X + dim].tolist()),
            source=self.source_name(int(link[SOURCE])),
            heading=tuple(fields[HX : HX + dim].tolist()),
            attraction=int(link[ATTRACTION]),
            diffusion=float(fields[DIFFUSION]),
            goal_radius=float(fields[GOAL]),
            evaporation_factor=float(fields[FACTOR]),
            evaporation_period=float(fields[PERIOD]),
            stamp=float(fields[STAMP]),
            clock=float(clock),
            moving=int(link[LAYER]) % LEVELS == MOVING,
            payload=self._payloads.get(int(link[SERIAL]), {}),
        )

    def source_name(self, code: int) -> int | str:
        """Return what `source_code` numbered: the name of a source, or the row itself if rows have no names."""
        if 0 <= code < self.poses.rows:
            return self.poses.names[code] if self.poses.names else code
        return self._source_names[code - self.poses.rows] if code >= 0 else ""

    def keeps(self, channel: str) -> bool:
        """Tell whether gradients of `channel` are stored at all."""
        return self.settings.store_all or channel in self.settings.channels

    def channel_code(self, channel: str) -> int:
        """Return the number of `channel`, a new one if it was never heard of."""
        code = self._channel_codes.get(channel)
        if code is None:
            code = self._channel_codes[channel] = len(self.channel_names)
            self.channel_names.append(channel)
            self.rules = np.append(self.rules, self.settings.rule_of(channel))
            more = np.zeros((self.spaces * LEVELS, LAYER_COLUMNS), dtype=np.int32)
            more[:] = -1
            more[:, COUNT] = 0
            self._layers = np.concatenate([self._layers, more])
            self._counters[CHANNELS] = code + 1
            self.tables = self._tables()
        return code

    def channel_table(self, channels: Iterable[str]) -> Ints:
        """Return what compiled code needs to see `channels` (none given: all): 1 if the own poses' is among them, then codes.

        In the order of their names: the order in which other teams brought them up must not change a sum.
        """
        names = sorted(set(channels))
        with_poses = not names or self.poses.channel in names
        codes = [
            self._channel_codes[name] for name in names or sorted(self._channel_codes) if name in self._channel_codes
        ]
        return np.array([int(with_poses), *codes], dtype=np.int64)

    def source_code(self, source: int | str) -> int:
        """Return the number of `source`: a row is its own number, names are numbered after the rows."""
        if isinstance(source, str) and source in self.poses.names:
            return self.poses.names.index(source)
        if isinstance(source, str):
            if source not in self._source_codes:
                self._source_codes[source] = self.poses.rows + len(self._source_names)
                self._source_names.append(source)
            return self._source_codes[source]
        return int(source)

    def _check_teams(self, teams: npt.ArrayLike) -> Ints:
        codes: Ints = np.asarray(teams, dtype=np.int64)
        if ((codes < 0) | (codes >= self.spaces)).any():
            raise ValueError(f"SoBuffer: teams must lie in 0..{self.spaces - 1}, got {teams}")
        return codes

    def _messages(self, count: int) -> tuple[Floats, Ints]:
        return np.zeros((count, GRADIENT_COLUMNS)), np.zeros((count, TAG_COLUMNS), dtype=np.int64)

    def _store(self, messages: Floats, tags: Ints, now: float) -> None:
        self._reserve(len(messages))
        store_rows(messages, tags, self.rules, float(now), self.tables)

    def _reserve(self, more: int) -> None:
        """Make room for `more` gradients, by doubling."""
        needed = int(self._counters[USED]) + more
        capacity = len(self._links)
        if needed <= capacity:
            return
        while capacity < needed:
            capacity *= 2
        stored = len(self._links)
        numbers = np.empty((capacity, GRADIENT_COLUMNS))
        numbers[:stored] = self._numbers
        self._numbers = numbers
        links = np.empty((capacity, LINK_COLUMNS), dtype=np.int32)
        links[:stored] = self._links
        self._links = links
        self._buckets = np.empty(capacity, dtype=np.int32)
        rebuild(self._links, self._layers, self._buckets, self._counters)
        self.tables = self._tables()

    def _tables(self) -> Store:
        """Pack what compiled code needs; see `selforg.gathering.Store`."""
        return (
            self._numbers, self._links, self._layers, self._buckets, self._grid, self._counters, self._limits,
            self._window, self.space.padded_extent,
        )  # fmt: skip

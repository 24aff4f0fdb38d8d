"""SoBuffer: the gradients that robots have received, stored so that near ones are found fast."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from selforg.arrays import Floats, Ints
from selforg.gradients.contents import TeamContents, put_team_contents, team_contents
from selforg.gradients.delivery import Delivery, Mail, address
from selforg.gradients.gradient import Gradient, check_fields, check_gradient, check_places, require
from selforg.gradients.poses import OwnPoses
from selforg.gradients.rows import Codes, read_gradient, set_times, write_gradient
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.gradients.store.storing import clear_space, evaporate_space, store_rows
from selforg.gradients.store.tables import Tables
from selforg.space import Space

MOST_STALE_PAYLOADS = 1024
MOST_IN_A_CALL = 1 << 16
"""Messages that are stored in one call: some tenths of a second, because compiled code does not hear of Ctrl-C."""


class SoBuffer:
    """Static and moving gradients of all teams in one table; a team sees only its own.

    Attributes:
        shared: whether the rows of a team share one content; otherwise each row has its own.
        mail: messages under way.
        channels, sources, keys: names by their numbers.
        payloads: by serial number.
        on_deposit: is told who leaves what; `tell_deposits` sets it.
        sent: takes what rows spread, messages, tags and time [s], in place of this buffer; None unless set, before
            programs are made.

    Example:
        >>> space = Torus(11.0, 11.0)
        >>> poses = OwnPoses(space, rows=1)
        >>> buffer = SoBuffer(BufferSettings(aggregation_distance=0.1), space, poses)
        >>> buffer.store(Gradient("garbage", (2.0, 3.0), stamp=0.0), now=0.0)

    """

    def __init__(
        self, settings: BufferSettings, space: Space, poses: OwnPoses, delivery: Delivery | None = None
    ) -> None:
        if space is not poses.space:
            raise ValueError("SoBuffer: the poses live in another space object than the buffer")
        self.settings, self.space, self.poses, self.delivery = settings, space, poses, delivery or Delivery()
        self.shared = self.delivery.ideal
        self.mail = Mail()
        self.channels, self.sources, self.keys = Codes(), Codes(poses.rows, poses.names), Codes()
        self.payloads: dict[int, Mapping[str, Any]] = {}
        self.table = Tables(settings, space, poses.team_count if self.shared else poses.rows, not self.shared)
        self.on_deposit: Callable[[Ints, Floats, Ints], None] | None = None
        self.sent: Callable[[Floats, Ints, float], None] | None = None

    def __len__(self) -> int:
        """Return how many gradients of all teams are stored; some of them may have evaporated since the last look."""
        return self.table.used

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

        teams and all fields: one value, or one for each (M,). All rows of a team get it, whatever the delivery.
        Raises ValueError naming the field that is impossible.
        """
        places = check_places("store_static", positions, self.space.dim)
        check_fields(attraction, diffusion, goal_radius, evaporation_factor, evaporation_period, now)
        if not self.keeps(channel):
            return
        messages, tags = self._static(teams, channel, places, now)
        messages[:, c.DIFFUSION], messages[:, c.GOAL_RADIUS] = diffusion, goal_radius
        far = messages[:, c.MESSAGE_FAR :]
        far[:, c.FAR_FACTOR], far[:, c.FAR_PERIOD] = evaporation_factor, evaporation_period
        sources = np.asarray(source)
        require(
            "source", sources, (sources >= -1) & (sources < self.poses.rows), f"a row below {self.poses.rows}, or -1"
        )
        tags[:, c.TAG_SOURCE], tags[:, c.TAG_SIGN] = sources, attraction
        self.store_tables(*self._for_all(messages, tags), now)

    def extinguish(self, teams: npt.ArrayLike, channel: str, positions: npt.ArrayLike, now: float) -> None:
        """Delete the nearest static gradient at each of `positions` (M, D) by spreading one that evaporates at once.

        The channel must aggregate by `new`, so that the spread gradient replaces the stored one.
        """
        rule = self.settings.aggregation.get(channel, self.settings.aggregation.get("DEFAULT"))
        if rule != "new":
            raise ValueError(f"extinguish: channel {channel!r} must aggregate by 'new', its rule is {rule!r}")
        places = check_places("extinguish", positions, self.space.dim)
        if self.keeps(channel):
            messages, tags = self._static(teams, channel, places, now)  # blank: without reach, neither sign nor period
            messages[:, c.MESSAGE_FAR + c.FAR_FACTOR], tags[:, c.TAG_SOURCE] = 1.0, -1
            self.store_tables(*self._for_all(messages, tags), now)

    def store(self, gradient: Gradient, now: float, *, team: int = 0) -> None:
        """Store one gradient that all of a team received at `now` [s]; ValueError names a field that is impossible."""
        self._store_gradient(gradient, now, self._spaces(team))

    def receive(self, gradient: Gradient, now: float, *, row: int) -> None:
        """Store one gradient that a row received at `now` [s]; the row's own pose gradient becomes its pose."""
        own = self.source_code(gradient.source) == row
        if not (own and gradient.moving and gradient.channel == self.poses.channel):
            self._store_gradient(gradient, now, np.array([row if not self.shared else self.poses.teams[row]]))
            return
        check_gradient(gradient, self.space.dim)
        if self.settings.whole_seconds:
            evaporate_space(
                row if not self.shared else int(self.poses.teams[row]), float(now), self.table.packed.handle
            )
        self.poses.set_gradient(row, gradient)

    def spread(self, messages: Floats, tags: Ints, now: float) -> None:
        """Spread messages (M, MESSAGE_COLUMNS) with tags (M, TAG_COLUMNS) from rows (TAG_SOURCE) by `delivery`."""
        tags[:, c.TAG_SPACE] = self.poses.teams[tags[:, c.TAG_SOURCE]]
        if self.sent is not None:
            self.sent(messages, tags, now)
            return
        if self.shared:
            self.store_tables(messages, tags, now)
            return
        messages, tags = address(messages, tags, self.poses, self.delivery)
        if self.delivery.delay > 0:
            self.mail.add(now + self.delivery.delay, messages, tags)
        else:
            self.store_tables(messages, tags, now)

    def tell_deposits(self, told: Callable[[Ints, Floats, Ints], None] | None) -> None:
        """Tell a function, or nobody any more, who leaves what: rows (R,), message and tag."""
        self.on_deposit, self.table.record.counters[c.COUNTER_LISTENED] = told, told is not None

    def deliver(self, now: float) -> None:
        """Store the messages that are due at `now` [s]; call it before the rows look. Does nothing without a delay."""
        for _, messages, tags in self.mail.collect(now):
            self.store_tables(messages, tags, now)

    def clear(self, team: int) -> None:
        """Delete everything that one team has stored, and its messages under way."""
        self._clear_spaces(self._spaces(team))

    def clear_rows(self, rows: Ints) -> None:
        """Delete what `rows` (R,) have stored, and messages under way to them; shared gradients of a team stay."""
        if not self.shared:
            self._clear_spaces(rows)

    def evaporate(self, now: float) -> None:
        """Evaporate everything up to `now` [s] and free memory of deleted gradients; answers do not depend on it."""
        for space in range(self.table.spaces):
            evaporate_space(space, float(now), self.table.packed.handle)

    def count(self, team: int, channel: str) -> int:
        """Return how many gradients of `channel` a team has stored; see `__len__`."""
        return self.table.count(self.channels.code(channel), self._spaces(team)) if channel in self.channels else 0

    def keeps(self, channel: str) -> bool:
        """Return whether gradients of `channel` are stored at all."""
        return self.settings.store_all or channel in self.settings.channels

    def channel_code(self, channel: str) -> int:
        """Return the number of `channel`, a new one if it was never used."""
        if channel not in self.channels:
            self.table.add_channel(self.settings.rule_of(channel))
        return self.channels.code(channel)

    def source_code(self, source: int | str) -> int:
        """Return the number of `source`: a row is its own number, names are numbered after the rows."""
        if isinstance(source, str):
            return self.sources.code(source)
        if isinstance(source, bool) or not isinstance(source, (int, np.integer)) or not -1 <= source < self.poses.rows:
            raise ValueError(
                f"gradient: source must be a name or a row in 0..{self.poses.rows - 1} (-1: nobody), got {source!r}"
            )
        return int(source)

    def source_name(self, code: int) -> int | str:
        """Return what `source_code` numbered; rows without names are numbers."""
        if 0 <= code < self.poses.rows:
            return self.poses.names[code] if self.poses.names else code
        return self.sources.name(code) if code >= 0 else ""

    def gradient_of(self, pair: Floats) -> Gradient:
        """Return the gradient of one pair (PAIR_COLUMNS,) as it was seen; `clock` is when it last evaporated."""
        slot = int(pair[c.PAIR_SLOT])
        if slot < 0:
            age, row = divmod(-1 - slot, self.poses.rows)
            return self.poses.gradient(row, age)
        store = self.table.record
        near, far, link, mark = store.near[slot], store.far[slot], store.links[slot], store.marks[slot]
        clock = near[c.NEAR_DUE] - far[c.FAR_PERIOD] if np.isfinite(near[c.NEAR_DUE]) else far[c.FAR_CLOCK]
        payload = self.payloads.get(int(mark[c.MARK_SERIAL]), {})
        if not payload and mark[c.MARK_KEY] >= 0:
            payload = {self.keys.name(int(mark[c.MARK_KEY])): float(far[c.FAR_VALUE])}
        return read_gradient(
            near,
            far,
            self.space.dim,
            channel=self.channels.name(int(link[c.LINK_LAYER]) // (c.LEVELS * store.spaces)),
            source=self.source_name(int(mark[c.MARK_SOURCE])),
            attraction=int(link[c.LINK_SIGN]),
            clock=float(clock),
            moving=int(link[c.LINK_LAYER]) % c.LEVELS == c.MOVING,
            payload=payload,
        )

    def gradient_of_message(self, message: Floats, tag: Ints) -> Gradient:
        """Return what is about to be spread, message (MESSAGE_COLUMNS,) and tag (TAG_COLUMNS,), as one object."""
        far, key = message[c.MESSAGE_FAR :], int(tag[c.TAG_KEY])
        return read_gradient(
            message,
            far,
            self.space.dim,
            channel=self.channels.name(int(tag[c.TAG_CHANNEL])),
            source=int(tag[c.TAG_SOURCE]),
            attraction=int(tag[c.TAG_SIGN]),
            moving=bool(tag[c.TAG_MOVING]),
            payload={} if key < 0 else {self.keys.name(key): float(far[c.FAR_VALUE])},
        )

    def blank(self, count: int, channel: str) -> tuple[Floats, Ints]:
        """Return messages (count, MESSAGE_COLUMNS) and tags (count, TAG_COLUMNS) to fill, on one channel."""
        tags = np.zeros((count, c.TAG_COLUMNS), dtype=np.int64)
        tags[:, c.TAG_CHANNEL], tags[:, c.TAG_KEY] = self.channel_code(channel), -1
        return np.zeros((count, c.MESSAGE_COLUMNS)), tags

    def store_tables(self, messages: Floats, tags: Ints, now: float) -> None:
        """Store checked messages (M, MESSAGE_COLUMNS) with tags (M, TAG_COLUMNS), one after the other."""
        for begin in range(0, len(messages), MOST_IN_A_CALL):
            part = slice(begin, begin + MOST_IN_A_CALL)
            self.table.reserve(len(messages[part]))
            store_rows(messages[part], tags[part], float(now), self.table.packed.handle)

    def part_of(self, team: int) -> TeamContents:
        """Return the stored gradients of a team, with its messages under way."""
        return team_contents(self, team)

    def put_part(self, team: int, state: TeamContents, later: float) -> None:
        """Replace the stored gradients of a team by the result of `part_of`, `later` [s] after it; as many rows."""
        put_team_contents(self, team, state, later)

    def layers_of(self, team: int, channels: Ints) -> Ints:
        """Return the layers of a team on `channels`, channel by channel."""
        spaces = channels[:, None] * self.table.spaces + self._spaces(team)
        return (spaces.reshape(-1, 1) * c.LEVELS + np.arange(c.LEVELS)).reshape(-1)

    def _clear_spaces(self, spaces: Ints) -> None:
        for space in spaces.tolist():
            clear_space(space, self.table.packed.handle)
        self.mail.forget(spaces)

    def _spaces(self, team: int) -> Ints:
        """Return the information spaces of a team."""
        self._check_teams(team)
        return np.array([team]) if self.shared else self.poses.members(team)

    def _check_teams(self, teams: npt.ArrayLike) -> Ints:
        codes: Ints = np.asarray(teams, dtype=np.int64)
        if ((codes < 0) | (codes >= self.poses.team_count)).any():
            raise ValueError(f"SoBuffer: teams must lie in 0..{self.poses.team_count - 1}, got {teams!r}")
        return codes

    def _static(self, teams: npt.ArrayLike, channel: str, places: Floats, now: float) -> tuple[Floats, Ints]:
        """Return messages and tags for `places` (M, D) [m] at `now` [s], their other fields to be filled."""
        messages, tags = self.blank(len(places), channel)
        messages[:, c.X : c.X + self.space.dim] = self.space.wrap(places)
        set_times(messages, now)
        tags[:, c.TAG_SPACE] = self._check_teams(teams)
        return messages, tags

    def _store_gradient(self, gradient: Gradient, now: float, spaces: Ints) -> None:
        check_gradient(gradient, self.space.dim)
        source = self.source_code(gradient.source)
        if not self.keeps(gradient.channel):
            return
        messages, tags = self.blank(len(spaces), gradient.channel)
        write_gradient(gradient, self.space, self.keys, messages, tags)
        tags[:, c.TAG_SPACE], tags[:, c.TAG_SOURCE] = spaces, source
        if gradient.payload:
            self._keep_payload(gradient.payload, len(spaces))
        self.store_tables(messages, tags, now)

    def _keep_payload(self, payload: Mapping[str, Any], copies: int) -> None:
        """Keep the payload of the next `copies` messages, and delete payloads of gradients that are gone."""
        if len(self.payloads) > 2 * len(self) + MOST_STALE_PAYLOADS:
            live = self.table.serials()
            self.payloads = {serial: kept for serial, kept in self.payloads.items() if serial in live}
        first = int(self.table.record.counters[c.COUNTER_SERIAL]) + 1
        self.payloads.update((serial % c.SERIALS, payload) for serial in range(first, first + copies))

    def _for_all(self, messages: Floats, tags: Ints) -> tuple[Floats, Ints]:
        """Return messages and tags, TAG_SPACE a team, once for every information space of that team."""
        if self.shared:
            return messages, tags
        rows = [self.poses.members(int(team)) for team in tags[:, c.TAG_SPACE]]
        copies = np.repeat(np.arange(len(tags)), [len(members) for members in rows])
        messages, tags = messages[copies], tags[copies]
        tags[:, c.TAG_SPACE] = np.concatenate(rows)
        return messages, tags

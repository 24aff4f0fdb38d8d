"""Families of scenarios: from a seed, a split and a number to a mission, its start and its events.

A scenario is drawn from one whole number, its seed. The seeds of the split "train" are even, those of "test" odd: no
scenario belongs to both splits. All scenarios of one family with the same torus have one frame (`frames`), so that one
batch of worlds can hold them.
"""

import re
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from clean_swarm_env.config.events import Join
from clean_swarm_env.config.frames import check_frame
from clean_swarm_env.config.known import knowing
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import drawn_start
from clean_swarm_env.config.tasks import TaskSettings, find_task, items_of, with_changes
from clean_swarm_env.config.types import ArrivalRate, Items, Length, Point, Robots, Scenarios
from selector.documents.errors import DocumentError, check_unique, impossible, validated, within
from selector.documents.fields import Closed, Label, Name, Positive, Share
from selector.documents.plain import short

Split = Literal["train", "test"]
SPLITS: Final = ("train", "test")
SCENARIO_NAME: Final = r"(?:train|test)-([1-9][0-9]{0,5})(?:\.([1-9][0-9]{0,2}))?"
"""Form of the name of a scenario: its number, and that of its world unless it is the first."""
SCENARIO: Final = 0xFFFFFFFE
"""Spawn key of the draws of the scenario itself; the world draws from other keys of the same seed."""

Change = Literal["join", "remove", "fail", "land", "respawn", "move_spots", "move_stations", "deliver"]
Span = tuple[ArrivalRate, ArrivalRate]
Changes = Annotated[int, Field(strict=True, ge=0, le=1000)]
"""Events of a scenario; more of them would hardly differ in time."""
SpotCount = Annotated[int, Field(strict=True, ge=0, le=100)]
"""Spots of garbage; see `types.Spots`."""
PlaceCount = Annotated[int, Field(strict=True, ge=1, le=100)]
"""Places of the stations of a kind; as many as a kind may have."""


@dataclass(frozen=True)
class Scenario:
    """One mission of a family.

    Attributes:
        id: name within its family and split.
        seed: seed of everything random in it, see `Worlds.reset`.
        mission: the mission, with its events.
        start: where robots and items are at first.

    """

    id: str
    seed: int
    mission: MissionConfig
    start: StartConfiguration


def check_span(key: str, span: tuple[float, float]) -> None:
    """Raise the error of a span at the dotted `key` whose least number is larger than its largest."""
    if span[0] > span[1]:
        raise impossible(key, "the least before the largest", f"[{span[0]:g}, {span[1]:g}]")


def drawn_numbers(mission: MissionConfig) -> dict[str, float]:
    """Return the numbers of a mission that a family draws by keys of its own."""
    items = items_of(mission)
    return {"robots": mission.robots.count, "items": items.count, "respawn": items.respawn}


class ChangesConfig(Closed):
    """Number, kinds and sizes of the events of a scenario."""

    number: tuple[Changes, Changes] = (0, 0)
    """Least and largest number of events."""
    kinds: tuple[Change, ...] = ()
    """Kinds of events, all equally likely."""
    phases: Changes = 0
    """Phases of equal length in which garbage comes at one new spot and anywhere, in turn; 0: none."""
    items: tuple[Items, Items] = (5, 5)
    """Least and largest number of items that land at a time."""
    respawn: Span = (0.0, 6.0)
    """Least and largest rate at which garbage keeps coming after a change [1/min]."""
    reach: tuple[Positive, Positive] = (2.0, 6.0)
    """Least and largest range of messages after a change of the delivery [m]."""
    loss: tuple[Share, Share] = (0.0, 0.9)
    """Least and largest probability of a loss after a change of the delivery [-]."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        for name in ("number", "items", "respawn", "reach", "loss"):
            check_span(name, getattr(self, name))
        if self.number[1] > 0 and not self.kinds:
            raise impossible("kinds", "at least one kind of event", "none")
        if self.number[1] > 0 and self.phases > 0:
            raise impossible("phases", "0 beside events at random times (number)", self.phases)
        return self


class Disturbance(Closed):
    """One disturbance of a comparison."""

    kind: Name
    """Name of its kind; the levels of one kind are drawn as one line."""
    level: Name
    """Name of how large it is."""
    mission: MissionConfig
    """The mission under it; a document gives what differs from the mission of the comparison."""

    @property
    def name(self) -> str:
        """Name in all results."""
        return f"{self.kind} {self.level}"


UNDISTURBED: Final = "none"
"""Name of the missions without a disturbance."""


class FamilyConfig(Closed):
    """A family of scenarios: a mission, and the ranges of the draws for each scenario."""

    name: Name
    """Name of the family."""
    description: str
    """Particulars of its scenarios, in one sentence."""
    mission: MissionConfig = Field(default_factory=MissionConfig)
    """The mission; a scenario changes the drawn keys. Its events happen in every scenario."""
    alternatives: Annotated[tuple[dict[str, Any], ...], Field(max_length=100)] = ()
    """Changes of the mission, one of which each scenario has, all equally likely; the mission as it is if empty."""
    sizes: Annotated[tuple[tuple[Length, Length], ...], Field(max_length=1000)] = ()
    """Widths and heights of tori, one of which is drawn; if empty, the torus of the mission [m]."""
    robots: tuple[Robots, Robots] = (5, 5)
    """Least and largest number of robots at the start; that of the mission unless given."""
    groups: dict[Name, tuple[Robots, Robots]] = Field(default={})
    """Instead of `robots`: least and largest number of robots of some of the models of the mission."""
    items: tuple[Items, Items] = (10, 10)
    """Least and largest number of items at the start; that of the mission unless given."""
    respawn: Span = (0.0, 0.0)
    """Least and largest rate at which garbage keeps coming; that of the mission unless given [1/min]."""
    spots: tuple[SpotCount, SpotCount] | None = None
    """Least and largest number of spots of garbage, at random places; those of the mission unless given."""
    stations: Literal["given", "random"] = "given"
    """Whether the stations are where the mission has them, or as many of them at random places."""
    station_places: tuple[PlaceCount, PlaceCount] | None = None
    """Least and largest number of random places for the stations of each kind; one for each station unless given."""
    harmless: Share = 0.0
    """Probability that collisions are harmless in a scenario [-]."""
    changes: ChangesConfig = ChangesConfig()
    """The events that are drawn."""
    starts: tuple[StartConfiguration, ...] = ()
    """Start configurations of the split "test", taken in turn; random ones if empty, as in the split "train"."""
    scenarios: Scenarios = 100
    """Number of scenarios of an evaluation."""
    strategies: tuple[Label, ...] = ()
    """Strategies to compare unless others are named, as `clean-swarm evaluate --strategy` takes them."""
    disturbances: Annotated[tuple[Disturbance, ...], Field(max_length=100)] = ()
    """Disturbances under which strategies are compared, too."""
    draws_as: Name | None = None
    """Name whose scenarios these are, as one that the family had; its own unless given."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.station_places is not None and self.stations == "given":
            raise impossible("station_places", "stations: random", "stations: given")
        own = drawn_numbers(self.mission)
        self.__dict__.update({name: (one, one) for name, one in own.items() if name not in self.model_fields_set})
        self._sum_groups()
        for name in ("robots", "items", "respawn", "spots", "station_places"):
            check_span(name, getattr(self, name) or (0, 0))
        for name in ("robots", "items"):
            counts = {len(getattr(start, name)) for start in self.starts}
            if counts and counts != set(getattr(self, name)):
                raise impossible(name, f"the numbers of the given starts, {sorted(counts)}", list(getattr(self, name)))
        as_given = bool(self.groups) or set(self.robots) == {self.mission.robots.count}
        if self.mission.robots.groups and (not as_given or "join" in self.changes.kinds):
            expected = f"{self.mission.robots.count}, as in the groups of the mission, or `groups`; and no joins drawn"
            raise impossible("robots", expected, list(self.robots))
        self._check_scenarios()
        check_unique("disturbances", [UNDISTURBED, *(disturbance.name for disturbance in self.disturbances)])
        for k, disturbance in enumerate(self.disturbances):
            with within(f"disturbances.{k}"):
                self._under(disturbance)._check_scenarios()
        return self

    @property
    def variants(self) -> dict[str, Self]:
        """The family without and under each disturbance, by name; only itself without a name if it has none."""
        under = {each.name: self._under(each) for each in self.disturbances}
        return {UNDISTURBED: self, **under} if under else {"": self}

    def scenario_named(self, seed: int, name: str) -> Scenario:
        """Return the scenario of a name such as `test-3`; DocumentError if there is none."""
        index, world = place_of(name)
        return self.scenario(seed, index, "train" if name.startswith("train") else "test", world)

    def bound(self, name: str) -> MissionConfig:
        """Return a mission as large as that of a scenario or larger; DocumentError if there is no such scenario."""
        place_of(name)
        return self.largest

    def scenario(self, seed: int, index: int, split: Split, world: int = 0) -> Scenario:
        """Return scenario `index` (from 0) of a split, the same for the same seed.

        Those of further worlds (from 1) have the same mission and start; what is random in the world itself differs.
        """
        if split not in SPLITS or min(seed, index, world) < 0:
            expected = f"a seed, an index and a world from 0 up and a split of {SPLITS}"
            raise ValueError(f"family {self.name!r}: expected {expected}, got {seed}, {index}, {world}, {split!r}")
        own = seed_of(self.draws_as or self.name, seed, index, split)
        for_mission, for_start = np.random.SeedSequence(own, spawn_key=(SCENARIO,)).spawn(2)
        mission = self._mission(np.random.default_rng(for_mission))
        if self.starts and split == "test":
            start = self.starts[index % len(self.starts)]
        else:
            start = drawn_start(mission, for_start, str(index + 1))
        if world:
            own = _of_split(np.random.SeedSequence([own, world]), split)
        return Scenario(scenario_name(split, index, world), own, mission, start)

    def with_knowledge(self, name: str | None, directories: Sequence[Path] = ()) -> Self:
        """Return the family with the expert knowledge of a name, None: its own."""
        return self.model_copy(update={"mission": knowing(self.mission, name, directories)})

    @property
    def largest(self) -> MissionConfig:
        """The mission with the most robots, on the first torus and without events; items have room in it as in all."""
        own = self._with_alternative(0) if self.alternatives else self
        return own._largest_on(own.tori[0])

    @property
    def missions(self) -> list[MissionConfig]:
        """The mission with each of the alternatives; only itself without any."""
        return [self._with_alternative(k).mission for k in range(len(self.alternatives))] or [self.mission]

    def _with_alternative(self, number: int) -> Self:
        """Return the family that has one of the alternatives in all its scenarios."""
        whole = with_changes(self.mission.model_dump(), self.alternatives[number])
        mission = validated(MissionConfig, whole, f"alternatives.{number}", own=True)
        return self.model_copy(update={"mission": mission, "alternatives": ()})

    def _check_alternatives(self) -> None:
        """Raise the error of the first alternative that is impossible, or has another frame than those on its torus."""
        frames, drawn = dict[tuple[float, float], MissionConfig](), drawn_numbers(self.mission)
        for number in range(len(self.alternatives)):
            own = self._with_alternative(number)
            for key, value in drawn_numbers(own.mission).items():
                if value != drawn[key]:
                    expected = f"{drawn[key]:g} as in the mission, because the family draws it"
                    raise impossible(f"alternatives.{number}.{key}", expected, value)
            if self.sizes and own.mission.size.tolist() != self.mission.size.tolist():
                expected = "the size of the mission beside `sizes`"
                raise impossible(f"alternatives.{number}.world", expected, own.mission.size.tolist())
            with within(f"alternatives.{number}"):
                own._check_scenarios()
                check_frame(own.largest, frames.setdefault(own.tori[0], own.largest))

    def _under(self, disturbance: Disturbance) -> Self:
        """Return the family under a disturbance; its scenarios have the same starts."""
        return self.model_copy(update={"mission": disturbance.mission, "disturbances": ()})

    def _sum_groups(self) -> None:
        """Check the numbers of robots of models, if they are drawn, and let `robots` be their sums."""
        names = [model.model for model in self.mission.robots.groups]
        for name, span in self.groups.items():
            if name not in names:
                expected = f"models of the mission's groups ({', '.join(names) or 'it has none'})"
                raise impossible("groups", expected, repr(name))
            check_span(f"groups.{name}", span)
        totals = tuple(sum(spans) for spans in zip(*self._spans, strict=True))
        if self.groups and "robots" in self.model_fields_set and self.robots != totals:
            raise impossible("robots", "nothing beside `groups`", list(self.robots))
        self.__dict__["robots"] = totals

    @property
    def _spans(self) -> list[tuple[int, int]]:
        """Least and largest number of robots: of all, or of each group of the mission if they are drawn."""
        if not self.groups:
            return [self.robots]
        groups = self.mission.robots.groups
        return [self.groups.get(group.model, (group.count, group.count)) for group in groups]

    def _check_scenarios(self) -> None:
        """Raise the error of the first torus on which the largest team or the given stations do not fit.

        A family without a possible scenario is refused, too.
        """
        if self.alternatives:
            self._check_alternatives()
            return
        if self.mission.events and max(self.changes.number[1], self.changes.phases) > 0:
            expected = "none where events are drawn (changes.number, changes.phases)"
            raise impossible("mission.events", expected, len(self.mission.events))
        for size in self.tori:
            with within("sizes" if self.sizes else "mission"):
                self._largest_on(size)
        self.scenario(0, 0, "train")

    def _largest_on(self, size: Point) -> MissionConfig:
        task, _ = find_task(self.mission.task.name).draw_scenario(self, size, self._rows, np.random.default_rng(0))
        joining = [event.model_dump() for event in self.mission.events if isinstance(event, Join)]
        counts = [most for _, most in self._spans] if self.groups else [self._rows]
        return self._made(size, counts, task, joining if self.mission.robots.groups else [])

    @property
    def tori(self) -> tuple[tuple[float, float], ...]:
        """Width and height of every torus that scenarios may have [m], each once."""
        sizes = self.sizes or [(mission.world.width, mission.world.height) for mission in self.missions]
        return tuple(dict.fromkeys(sizes))

    def _mission(self, rng: np.random.Generator) -> MissionConfig:
        if self.alternatives:
            return self._with_alternative(int(rng.integers(len(self.alternatives))))._mission(rng)
        sizes = self.sizes or self.tori
        size = sizes[int(rng.integers(len(sizes)))]
        counts = [int(rng.integers(least, most + 1)) for least, most in self._spans]
        task, drawn = find_task(self.mission.task.name).draw_scenario(self, size, sum(counts), rng)
        return self._made(size, counts, task, [event.model_dump() for event in self.mission.events] or drawn)

    def _made(self, size: Point, counts: list[int], task: TaskSettings, events: list[dict[str, Any]]) -> MissionConfig:
        """Return the mission on a torus of a `size` [m] with the numbers of robots that `_spans` has the bounds of.

        Raises:
            DocumentError: it is impossible.

        """
        base = self.mission
        robots: dict[str, Any] = {} if base.robots.groups else {"count": counts[0]}
        if self.groups:
            pairs = zip(base.robots.groups, counts, strict=True)
            robots = {"groups": [{**group.model_dump(), "count": count} for group, count in pairs]}
        parts: dict[str, dict[str, Any]] = {
            "world": {"width": size[0], "height": size[1]},
            "robots": {"capacity": self._rows, **robots},
            "delivery": {"own_contents": base.own_contents or "deliver" in self.changes.kinds},
        }
        merged = {name: {**getattr(base, name).model_dump(), **change} for name, change in parts.items()}
        own = {"name": self.name, "task": task.model_dump(), "events": events}
        whole = {**base.model_dump(), **merged, **own}
        return validated(MissionConfig, whole, f"{sum(counts)} robots on {size[0]:g} m x {size[1]:g} m", own=True)

    @property
    def _rows(self) -> int:
        changes = self.changes.number[1] if "join" in self.changes.kinds else 0
        joining = sum(event.robots for event in self.mission.events if isinstance(event, Join))
        return max(self.robots[1] + changes + joining, self.mission.robots.capacity)


def seed_of(family: str, seed: int, index: int, split: Split) -> int:
    """Return the seed of a scenario, below 2^64: even in the split "train", odd in "test"."""
    words = [SPLITS.index(split), zlib.crc32(family.encode()), index, seed]
    return _of_split(np.random.SeedSequence(words), split)


def _of_split(sequence: np.random.SeedSequence, split: Split) -> int:
    return int(sequence.generate_state(1, np.uint64)[0]) // 2 * 2 + SPLITS.index(split)


def scenario_name(split: Split, index: int, world: int = 0) -> str:
    """Return the name of scenario `index` (from 0) of a split in one of its worlds, as `test-3` or `test-3.2`."""
    return f"{split}-{index + 1}.{world + 1}" if world else f"{split}-{index + 1}"


def place_of(name: str) -> tuple[int, int]:
    """Return index and world of the name of a scenario; DocumentError if it is none."""
    found = re.fullmatch(SCENARIO_NAME, name)
    if found is None:
        raise DocumentError(f"expected a scenario such as test-3 or test-3.2, got {short(name)}")
    return int(found[1]) - 1, int(found[2] or 1) - 1

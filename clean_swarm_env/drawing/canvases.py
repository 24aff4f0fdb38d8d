"""Canvases of a world of a batch as it is now, and of a recorded mission at any time, also between two frames."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from pydantic import AliasChoices, AliasPath, BaseModel, Field

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.drawing.canvas import GARBAGE, LEFTOVERS, SEARCHING, Area, Canvas, Zone, between, no_places
from clean_swarm_env.drawing.look import LOOK
from clean_swarm_env.recording.fields import traces_at
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.sampled import things_of, walls_shown, zones_shown
from clean_swarm_env.tasks.cleaning.garbage import ABSENT, DONE, LYING, NOTHING
from clean_swarm_env.tasks.cleaning.movers import PHEROMONES
from clean_swarm_env.tasks.cleaning.settings import StationsConfig
from clean_swarm_env.world.worlds import Worlds
from selector.documents.errors import validated
from selector.documents.fields import NonNegative, Number, Positive
from selforg.arrays import Floats
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c

ROBOT, ITEM, STATION, THING = "robot", "item", "station", "thing"
CHANNELS = {
    "x": ROBOT,
    "y": ROBOT,
    "heading": ROBOT,
    "present": ROBOT,
    "working": ROBOT,
    "cargo": ROBOT,
    "recycled": ROBOT,
    "deposit": ROBOT,
    "item_x": ITEM,
    "item_y": ITEM,
    "item_stage": ITEM,
    "item_leftover": ITEM,
    "station_x": STATION,
    "station_y": STATION,
    "thing_x": THING,
    "thing_y": THING,
}
"""Channels of which a picture is made, and what each has a number for."""
CARGO_CHANNELS = ("cargo", "recycled", "item_x", "item_y", "item_stage", "item_leftover", "station_x", "station_y")
"""Channels that recordings of other tasks need not have."""
HELD = "held/"
"""Beginning of the channels with the option that each robot holds, to be followed by a goal."""
DRAWN = (*CHANNELS, HELD)
"""How the names of the channels begin that pictures show; the others need not be kept for them."""
TRAILS = (PHEROMONES, "trail")
"""Channels of the gradients that are drawn: those of cleaning, and of Foraging."""
EDGE_OF_LAND = 2.0
"""Width of the land around the places where robots have been [m]."""
LAND_STEP = 5.0
"""Step by which the part of open land grows that is shown [m]."""
FRAME_ROUNDING = 1e-6
"""A time this little beside a frame is that of the frame [periods]."""


class DrawnThing(BaseModel):
    """A thing of a task other than cleaning, where it is at the start."""

    channel: str
    attraction: Literal[-1, 0, 1]
    x: Number
    y: Number
    radius: NonNegative
    moves: Annotated[int, Field(strict=True, ge=-1)] = -1
    """Its number among the things that move; -1: it stays where it is."""


class _Model(BaseModel):
    """What a picture takes of a model of robots."""

    model: str
    radius: Positive
    """[m]."""


class _Shown(BaseModel):
    """What a picture takes from the head."""

    radius: Annotated[
        Positive,
        Field(
            validation_alias=AliasChoices(
                AliasPath("mission", "robots", "radius"), AliasPath("mission", "robots", "groups", 0, "radius")
            )
        ),
    ]
    """Of the robots, or of those of the first model [m]."""
    groups: Annotated[tuple[_Model, ...], Field(validation_alias=AliasPath("mission", "robots", "groups"))] = ()
    """The models of robots that differ."""
    models: tuple[Annotated[int, Field(strict=True, ge=0)], ...] = ()
    """(N,) number of each robot's model, if they differ."""
    stations: Annotated[StationsConfig, Field(validation_alias=AliasPath("mission", "task", "stations"))] = (
        StationsConfig()
    )
    things: tuple[DrawnThing, ...] | None = None
    """Those of a task other than cleaning, which has no items and no stations."""
    ground: Literal["torus", "walled", "open"] = "torus"
    """Of open land the square is shown in which the robots have been."""
    shown: Annotated[tuple[Positive, ...], Field(max_length=2)] = ()
    """Width and height of the part that is shown of a walled field's torus [m]."""
    zones: tuple[tuple[str, Number, Number, Number, Number], ...] = ()
    """Name, lower left and upper right corner of each zone [m]."""
    walls: tuple[tuple[Number, Number, Number, Number], ...] = ()
    """x, y of either end of each wall [m]."""


class RecordedCourse:
    """The course of a recorded mission, as canvases.

    Raises:
        ConfigurationError: the recording lacks channels of the picture.

    """

    def __init__(self, recording: RecordedMission) -> None:
        head = recording.head
        self._recording = recording
        shown = self._shown = validated(_Shown, head, f"{recording.path}: head")
        self._models = np.array(shown.models, dtype=np.int64)
        self._radii = np.array([model.radius for model in shown.groups] or [shown.radius])
        if shown.groups and (len(shown.models) != head["robots"] or self._models.max() >= len(shown.groups)):
            expected = f"the model of each of {head['robots']} robots, below {len(shown.groups)}"
            raise ConfigurationError(f"{recording.path}: head: models: expected {expected}, got {shown.models}")
        self._options = {goal: names for goal, names in head["options"].items() if f"{HELD}{goal}" in recording}
        self._things = shown.things or ()
        moving = 1 + max((thing.moves for thing in self._things), default=-1)
        counts = {ROBOT: head["robots"], ITEM: head["items"], THING: moving}
        kinds = CHANNELS | {f"{HELD}{goal}": ROBOT for goal in self._options}
        spare = (*(() if shown.things is None else CARGO_CHANNELS), *(() if moving else ("thing_x", "thing_y")))
        lacking = [name for name in spare if name not in recording]
        self._names = [name for name in kinds if name not in lacking]
        for name in self._names:
            kind = kinds[name]
            shape = recording.channels[name].shape if name in recording else None
            if shape is None or (len(shape) != 1 or shape[0] != counts.get(kind, shape[0])):
                expected = f"channel {name} with a number for each {kind}"
                raise ConfigurationError(f"{recording.path}: expected {expected}, got shape {shape}")
        self._empty = {name: np.full(counts.get(kinds[name], 0), NOTHING) for name in lacking}
        self._corner, self._extent = np.zeros(2), (head["width"], head["height"])
        if len(shown.shown) == 2:
            self._extent = shown.shown[0], shown.shown[1]
        self._walls = np.array(shown.walls).reshape(-1, 4)
        if shown.ground == "open":
            places = np.stack([recording["x"], recording["y"]], axis=-1)
            low, high = places.min(axis=(0, 1)) - EDGE_OF_LAND, places.max(axis=(0, 1)) + EDGE_OF_LAND
            side = float((high - low).max())
            self._corner, self._extent = low, (side, side)
        stage = (recording["item_stage"] if "item_stage" in self._names else recording["x"][:, :0]).astype(np.int8)
        before = np.concatenate([np.full_like(stage[:1], ABSENT), stage[:-1]])
        self._dumped = ((stage == DONE) & (before != DONE)).sum(axis=1).cumsum()
        self._arrived = ((stage < DONE) & (before >= DONE)).sum(axis=1).cumsum()
        self._frame = lru_cache(2)(self._canvas)  # several pictures lie between two frames

    @property
    def end(self) -> float:
        """Time of the last frame [s]."""
        return float(self._recording.times[-1])

    def at(self, time: float) -> Canvas:
        """Return the canvas at a time [s] from 0 to `end`."""
        frame = min(int(time / self._recording.period + FRAME_ROUNDING), self._recording.frames - 1)
        now = self._frame(frame)
        share = time / self._recording.period - frame
        if share < FRAME_ROUNDING or frame + 1 == self._recording.frames:
            return now
        return between(now, self._frame(frame + 1), share)

    def _canvas(self, frame: int) -> Canvas:
        head = self._recording.head
        channels, own = self._recording.channels, slice(frame, frame + 1)
        now = {name: channels[name].values(self._recording.whole(name)[own])[0] for name in self._names} | self._empty
        there, lying = now["present"] == 1, now["item_stage"] == LYING
        loaded = np.where(now["recycled"] == 1, LEFTOVERS, GARBAGE)
        goal = next(iter(self._options), None)
        traces = traces_at(self._recording, frame)
        kinds = self._recording.notes.get("deposits", [])
        trail = np.isin(traces.kind, [k for k, kind in enumerate(kinds) if kind.get("channel") in TRAILS])
        counted = f"{self._dumped[frame]} of {self._arrived[frame]} items dumped" if head["items"] else ""
        return Canvas(
            np.stack([now["x"], now["y"]], axis=1)[there] - self._corner,
            now["heading"][there],
            width=self._extent[0],
            height=self._extent[1],
            closed=self._shown.ground != "walled",
            time=frame * self._recording.period,
            state=", ".join(filter(None, [str(head["about"].get("condition", "")), counted])),
            radius=self._radii[self._models[there]] if len(self._models) else self._shown.radius,
            models=self._models[there] if len(self._models) else None,
            model_names=tuple(model.model for model in self._shown.groups),
            cargo=np.where(now["cargo"] == NOTHING, SEARCHING, loaded)[there],
            numbers=np.flatnonzero(there),
            working=now["working"][there] == 1,
            options=tuple(self._options[goal]) if goal is not None else (),
            held=now[f"{HELD}{goal}"][there] if goal is not None else None,
            garbage=np.stack([now["item_x"], now["item_y"]], axis=1)[lying] if head["items"] else no_places(),
            leftover=now["item_leftover"][lying] == 1,
            stations=np.stack([now["station_x"], now["station_y"]], axis=1),
            station_kinds=self._shown.stations.kinds,
            station_radius=self._shown.stations.reach,
            areas=areas_of(self._things, self._corner, np.stack([now["thing_x"], now["thing_y"]], axis=1)),
            zones=moved_zones(self._shown.zones, self._corner),
            walls=self._walls - np.tile(self._corner, 2),
            pheromones=traces.positions[trail] - self._corner,
            pheromone_diffusions=traces.diffusion[trail],
        )


def moved_zones(zones: Iterable[tuple[str, float, float, float, float]], corner: Floats) -> tuple[Zone, ...]:
    """Return the zones of a picture whose lower left `corner` (2,) [m] is given."""
    return tuple(Zone(name, *(np.array(corners) - np.tile(corner, 2)).tolist()) for name, *corners in zones)


def areas_of(things: Sequence[DrawnThing], corner: Floats, moved: Floats) -> tuple[Area, ...]:
    """Return the areas of a picture whose lower left `corner` (2,) [m] is given; `moved` (K, 2) [m]: what moves."""
    areas = []
    for thing in things:
        x, y = (moved[thing.moves] if 0 <= thing.moves < len(moved) else np.array([thing.x, thing.y])) - corner
        areas.append(Area(thing.channel, float(x), float(y), max(thing.radius, LOOK.least_area), thing.attraction < 0))
    return tuple(areas)


def canvas_of(worlds: Worlds, world: int) -> Canvas:
    """Return the canvas of a world as it is now; the options are those of the first coordinated goal."""
    rows_of_world = worlds.rows_of(world)
    rows = rows_of_world[worlds.physics.present[rows_of_world]]
    coordinator = worlds.coordinators[0] if worlds.coordinators else None
    trail, diffusions = trail_of(worlds.minds.buffers["pheromones"], int(rows_of_world[0]), worlds.now)
    corner, size = shown_part(worlds, worlds.physics.positions[rows])
    width, height = size.tolist()
    things = [DrawnThing.model_validate(thing) for thing in things_of(worlds, world)]
    robots = worlds.mission.robots
    return Canvas(
        worlds.physics.positions[rows] - corner,
        worlds.physics.headings[rows].copy(),
        width=width,
        height=height,
        closed=worlds.floor.ground.kind != "walled",
        time=float(worlds.ticks[world]) * worlds.period,
        state=worlds.task.headline(world),
        radius=worlds.world.of_each("radius")[rows] if robots.groups else robots.radius,
        models=worlds.mission.models[rows - rows_of_world[0]] if robots.groups else None,
        model_names=tuple(group.model for group in robots.groups),
        numbers=rows - rows_of_world[0],
        working=worlds.team.working[rows].astype(np.bool_),
        options=coordinator.model.options if coordinator else (),
        held=coordinator.held[rows].copy() if coordinator else None,
        areas=areas_of(things, corner, no_places()),
        zones=moved_zones(zones_shown(worlds), corner),
        walls=walls_shown(worlds) - np.tile(corner, 2),
        pheromones=trail - corner,
        pheromone_diffusions=diffusions,
        **worlds.task.drawn(world, rows),
    )


def shown_part(worlds: Worlds, places: Floats) -> tuple[Floats, Floats]:
    """Return lower left corner (2,) and size (2,) [m] of the visible part of a world; `places` (K, 2) of its robots.

    Of open land it is a square around the middle: where robots start, and in steps what they have reached.
    """
    ground = worlds.floor.ground
    if ground.kind != "open":
        return np.zeros(2), ground.size
    side = float(ground.size.max())
    beyond = float(np.abs(places - ground.centre).max(initial=0.0)) + EDGE_OF_LAND - 0.5 * side
    side += 2.0 * LAND_STEP * float(np.ceil(max(beyond, 0.0) / LAND_STEP))
    return ground.centre - 0.5 * side, np.full(2, side)


def trail_of(buffer: SoBuffer, row: int, now: float) -> tuple[Floats, Floats]:
    """Return positions (M, 2) [m] and diffusions (M,) [m] of the pheromones that a row finds at `now` [s]."""
    everything = Filter(TRAILS, moving=False, view_distance=np.inf)
    pairs = Queries(buffer).gather(now, [row], everything, without_pose=True).pairs
    slots = pairs[:, c.PAIR_SLOT].astype(np.int64)
    return buffer.table.record.near[slots][:, [c.X, c.Y]], pairs[:, c.PAIR_DIFFUSION].copy()

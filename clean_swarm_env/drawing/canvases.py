"""Canvases of a world of a batch as it is now, and of a recorded mission at any time, also between two frames."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AliasPath, BaseModel, Field

from clean_swarm_env.config.robots import RobotConfig
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.drawing.canvas import NOTHING, Area, Canvas, SignedThings, Zone, between
from clean_swarm_env.drawing.look import LOOK
from clean_swarm_env.recording.fields import traces_at
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.sampled import things_of, walls_shown, zones_shown
from clean_swarm_env.world.parts.shown import ROBOT, WORLD, AnyArray, Drawn, chosen_of
from clean_swarm_env.world.worlds import Worlds
from selector.documents.errors import validated
from selector.documents.fields import NonNegative, Number, Positive
from selforg.arrays import Flags, Floats
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c

ITEM, THING = "item", "thing"
CHANNELS = dict.fromkeys(("x", "y", "heading", "present", "working", "deposit"), ROBOT)
"""Channels of which every picture is made, and what each has a number for; `Drawn` names further ones."""
HELD = "held/"
"""Beginning of the channels with the option that each robot holds, to be followed by a goal."""
TRAILS = ("pheromone", "trail")
"""Channels of the gradients that are drawn."""
EDGE_OF_LAND = 2.0
"""Width of the land around the places where robots have been [m]."""
LAND_STEP = 5.0
"""Step by which the part of open land grows that is shown [m]."""
FRAME_ROUNDING = 1e-6
"""A time this little beside a frame is that of the frame [periods]."""


class DrawnThing(BaseModel):
    """A thing without a sign, where it is at the start."""

    channel: str
    attraction: Literal[-1, 0, 1]
    x: Number
    y: Number
    radius: NonNegative
    moves: Annotated[int, Field(strict=True, ge=-1)] = -1
    """Its number among the things that move; -1: it stays where it is."""


class _Shown(BaseModel):
    """What a picture takes from the head."""

    robots: Annotated[RobotConfig, Field(validation_alias=AliasPath("mission", "robots"))]
    models: tuple[Annotated[int, Field(strict=True, ge=0)], ...] = ()
    """(N,) number of each robot's model, if they differ."""
    things: tuple[DrawnThing, ...] = ()
    """What lies in the world and has no sign."""
    drawn: tuple[Drawn, ...] = ()
    ground: Literal["torus", "walled", "open"] = "torus"
    """Of open land the square is shown in which the robots have been."""
    shown: tuple[Positive, Positive] | None = None
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
        self._radii, groups = np.array([model.radius for model in shown.robots.models]), shown.robots.groups
        if groups and (len(shown.models) != head["robots"] or self._models.max() >= len(groups)):
            expected = f"the model of each of {head['robots']} robots, below {len(groups)}"
            raise ConfigurationError(f"{recording.path}: head: models: expected {expected}, got {shown.models}")
        self._options = {goal: names for goal, names in head["options"].items() if f"{HELD}{goal}" in recording}
        moving = 1 + max((thing.moves for thing in shown.things), default=-1)
        counts = {ROBOT: head["robots"], ITEM: head["items"], THING: moving}
        kinds = CHANNELS | {f"{HELD}{goal}": ROBOT for goal in self._options} | drawn_channels(shown.drawn)
        kinds |= {"thing_x": THING, "thing_y": THING} if moving else {}
        kinds |= {one.name: WORLD for one in recording.channels.values() if one.axes == (WORLD,)}
        for name, kind in kinds.items():
            shape = recording.channels[name].shape if name in recording else None
            if shape is None or (len(shape) != 1 or shape[0] != counts.setdefault(kind, shape[0])):
                expected = f"channel {name} with a number for each {kind}"
                raise ConfigurationError(f"{recording.path}: expected {expected}, got shape {shape}")
        self._names = [*kinds]
        self._corner, self._extent = np.zeros(2), shown.shown or (head["width"], head["height"])
        self._walls = np.array(shown.walls).reshape(-1, 4)
        if shown.ground == "open":
            places = np.stack([recording["x"], recording["y"]], axis=-1)
            low, high = places.min(axis=(0, 1)) - EDGE_OF_LAND, places.max(axis=(0, 1)) + EDGE_OF_LAND
            side = float((high - low).max())
            self._corner, self._extent = low, (side, side)
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
        there = share < FRAME_ROUNDING or frame + 1 == self._recording.frames
        return now if there else between(now, self._frame(frame + 1), share)

    def _canvas(self, frame: int) -> Canvas:
        head = self._recording.head
        channels, now = self._recording.channels, self._recording.at(frame, self._names)
        there = now["present"] == 1
        goal = next(iter(self._options), None)
        traces = traces_at(self._recording, frame)
        kinds = self._recording.notes.get("deposits", [])
        trail = np.isin(traces.kind, [k for k, kind in enumerate(kinds) if kind.get("channel") in TRAILS])
        counted = (f"{now[one][0]} {channels[one].about}" for one in now if channels[one].axes == (WORLD,))
        values = {name: now[name] for one in self._shown.drawn for name in one.where}
        for at in {one.at for one in self._shown.drawn} - {ROBOT}:
            values[at] = np.stack([now[f"{at}_x"], now[f"{at}_y"]], axis=1)
        moved = np.stack([now["thing_x"], now["thing_y"]], axis=1) if "thing_x" in now else np.zeros((0, 2))
        return Canvas(
            np.stack([now["x"], now["y"]], axis=1)[there] - self._corner,
            now["heading"][there],
            width=self._extent[0],
            height=self._extent[1],
            closed=self._shown.ground != "walled",
            time=frame * self._recording.period,
            state=", ".join(filter(None, (str(head["about"].get("condition", "")), *counted))),
            radius=self._radii[self._models[there]] if len(self._models) else self._shown.robots.radius,
            models=self._models[there] if len(self._models) else None,
            model_names=tuple(model.model for model in self._shown.robots.groups),
            numbers=np.flatnonzero(there),
            working=now["working"][there] == 1,
            options=tuple(self._options[goal]) if goal is not None else (),
            held=now[f"{HELD}{goal}"][there] if goal is not None else None,
            areas=areas_of(self._shown.things, self._corner, moved),
            zones=moved_zones(self._shown.zones, self._corner),
            walls=self._walls - np.tile(self._corner, 2),
            pheromones=traces.positions[trail] - self._corner,
            pheromone_diffusions=traces.diffusion[trail],
            **signs_of(self._shown.drawn, values, there, self._corner),
        )


def drawn_channels(drawn: Iterable[Drawn]) -> dict[str, str]:
    """Return the names of the channels that signs need, and what each has a number for."""
    places = {f"{one.at}_{axis}": one.at for one in drawn if one.at != ROBOT for axis in "xy"}
    return {name: one.at for one in drawn for name in one.where} | places


def pictured(head: Mapping[str, Any]) -> tuple[str, ...]:
    """Return how the names of the channels begin that pictures show; the others need not be kept for them."""
    shown = validated(_Shown, head, "head")
    counted = (channel["name"] for channel in head["channels"] if channel["axes"] == [WORLD])
    return (*CHANNELS, HELD, THING, *drawn_channels(shown.drawn), *counted)


def signs_of(drawn: Iterable[Drawn], values: Mapping[str, AnyArray], there: Flags, corner: Floats) -> dict[str, Any]:
    """Return the fields of a canvas with signs: of things, and of what the robots carry that are `there` (N,).

    `values`: name of a shown array -> its values of one world: (N,) of robots, (M,) of things, or places (M, 2) [m].
    """
    signs: list[SignedThings] = []
    loads: list[str] = []
    load = np.full(len(there), NOTHING)
    for one in drawn:
        chosen = chosen_of(one, values, len(there) if one.at == ROBOT else len(values[one.at]))
        if one.at == ROBOT:
            load[chosen] = len(loads)
            loads.append(one.sign)
        else:
            signs.append(SignedThings(one.sign, values[one.at][chosen] - corner, one.radius))
    return {"signs": tuple(signs), "loads": tuple(loads), "load": load[there] if loads else None}


def moved_zones(zones: Iterable[Zone], corner: Floats) -> tuple[Zone, ...]:
    """Return the zones of a picture whose lower left `corner` (2,) [m] is given."""
    x, y = corner.tolist()
    return tuple((name, left - x, bottom - y, right - x, top - y) for name, left, bottom, right, top in zones)


def areas_of(things: Sequence[DrawnThing], corner: Floats, moved: Floats) -> tuple[Area, ...]:
    """Return the areas of a picture whose lower left `corner` (2,) [m] is given; `moved` (K, 2) [m]: what moves."""
    now = [moved[one.moves] if 0 <= one.moves < len(moved) else (one.x, one.y) for one in things]
    places = np.array(now).reshape(-1, 2) - corner
    return tuple(
        Area(one.channel, float(x), float(y), max(one.radius, LOOK.least_area), one.attraction < 0)
        for one, (x, y) in zip(things, places, strict=True)
    )


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
    values = {one.name: one.values[rows_of_world if one.axis == ROBOT else world] for one in worlds.task.shown()}
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
        areas=areas_of(things, corner, np.zeros((0, 2))),
        zones=moved_zones(zones_shown(worlds), corner),
        walls=walls_shown(worlds) - np.tile(corner, 2),
        pheromones=trail - corner,
        pheromone_diffusions=diffusions,
        **signs_of(worlds.task.drawn(), values, worlds.physics.present[rows_of_world], corner),
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

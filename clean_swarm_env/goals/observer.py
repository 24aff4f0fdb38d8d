"""Observations of robots in a scene, for all rows at once. Shapes: W worlds, N robots a world, R = W * N rows.

Every component lies within [-1, 1]. Directions (`_ahead`, `_left`) are unit vectors in the robot's frame. Distances are
divided by half the diagonal of the torus, or by the diagonal of the field on open land; unseen things are 1 away.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from clean_swarm_env.goals.play import Play
from clean_swarm_env.goals.settings import GoalObservation
from clean_swarm_env.learning.observation.observer import Observations
from clean_swarm_env.scenes.ground import Ground
from selforg.arrays import Flags, Floats
from selforg.elementary import unit_vectors

WAY = ("seen", "distance", "ahead", "left")


class GoalObserver:
    """Observations (R, F) of scenes of one kind.

    Args:
        config: terms and settings.
        play: any play of the kind; only its names and sizes count.

    Attributes:
        names: (F,) names of the components.
        bounds: (F,) largest amount of each component, 1.

    """

    def __init__(self, config: GoalObservation, play: Play) -> None:
        self.config = config
        self.names = tuple(name for term in config.terms for name in TERMS_OF_GOALS[term][0](play))
        self.bounds: Observations = np.ones(len(self.names), dtype=np.float32)

    def observe(self, play: Play, out: Observations) -> None:
        """Write what is now into `out` (R, F)."""
        parts = [TERMS_OF_GOALS[term][1](play, self.config) for term in self.config.terms]
        np.clip(np.concatenate(parts, axis=1), -1.0, 1.0, out=out, casting="same_kind")


def longest(ground: Ground) -> float:
    """Return the distance that counts as 1 [m]."""
    return float(np.sqrt(2.0)) * (0.5 * ground.side if ground.kind == "torus" else ground.field_side)


def in_own_frame(vectors: Floats, headings: Floats) -> Floats:
    """Return vectors (R, 2) of the world's frame in the frames of robots with headings (R,): ahead and left."""
    cosine, sine = unit_vectors(headings)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=1)


def way_to_nearest(play: Play, offsets: Floats, seen: Flags) -> Floats:
    """Return the way (R, 4), see `WAY`, to the nearest of things at offsets (R, M, 2) [m] that is `seen` (R, M)."""
    distances = np.where(seen, np.linalg.norm(offsets, axis=2), np.inf)
    nearest = distances.argmin(axis=1)[:, None]
    away, found = np.take_along_axis(distances, nearest, axis=1)[:, 0], seen.any(axis=1)
    unit = (
        np.take_along_axis(offsets, nearest[..., None], axis=1)[:, 0] / np.where(found & (away > 0), away, 1.0)[:, None]
    )
    unit[~found] = 0.0
    scaled = np.where(found, np.minimum(away / longest(play.scene.ground), 1.0), 1.0)
    return np.column_stack((found, scaled, in_own_frame(unit, play.scene.arena.headings)))


def see_command(play: Play, _: GoalObservation) -> Floats:
    """Return the vector that the mechanism asked for last, by the largest speed; longer ones are shortened."""
    vectors = play.asked / play.scene.body.max_speed
    short = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1.0)
    return in_own_frame(short, play.scene.arena.headings)


def see_around(play: Play, config: GoalObservation) -> Floats:
    """Return the ways to the nearest things in sight, kind by kind."""
    arena, ground = play.scene.arena, play.scene.ground
    positions, own, parts = (
        play.scene.positions[:, :, None],
        play.scene.body.pose_goal_radius,
        [np.zeros((arena.rows, 0))],
    )
    for kind in play.scene.around:
        offsets = ground.offsets(positions, kind.places[:, None]).reshape(arena.rows, -1, 2)
        clearance = np.linalg.norm(offsets, axis=2) - own - kind.goal_radius
        parts.append(way_to_nearest(play, offsets, clearance <= kind.diffusion + config.sight))
    return np.concatenate(parts, axis=1)


def see_neighbour(play: Play, config: GoalObservation) -> Floats:
    """Return the share of the other robots in range, and the way to the nearest of them."""
    arena, positions = play.scene.arena, play.scene.positions
    offsets = play.scene.ground.offsets(positions[:, :, None], positions[:, None]).reshape(arena.rows, arena.robots, 2)
    near = np.linalg.norm(offsets, axis=2) <= config.neighbour_range
    near[np.arange(arena.rows), np.arange(arena.rows) % arena.robots] = False
    way = way_to_nearest(play, offsets, near)
    way[:, 0] = near.sum(axis=1) / max(arena.robots - 1, 1)
    return way


def see_movement(play: Play, _: GoalObservation) -> Floats:
    """Return speed and turn rate of the drive, by the largest ones."""
    drive = play.scene.arena.drive
    limits = drive.settings
    return np.stack([drive.speed / limits.max_speed, drive.turn_rate / limits.max_turn_rate], axis=1)


def see_facts(play: Play, _: GoalObservation) -> Floats:
    """Return what the robot knows: 1 for a fact that is true."""
    facts = [play.team.memory[name].values for name in play.facts]
    return np.array(facts).reshape(len(facts), len(play.asked)).T


def see_time(play: Play, _: GoalObservation) -> Floats:
    """Return the share of the episode that is left."""
    return np.full((play.scene.arena.rows, 1), 1.0 - play.scene.arena.ticks / play.scene.chosen.ticks)


def see_holds(play: Play, _: GoalObservation) -> Floats:
    """Return one flag for each option: whether it is held."""
    flags: Floats = np.eye(len(play.team.options))[play.team.held]
    return flags


def kinds_of(play: Play) -> Sequence[str]:
    """Return the names of the kinds of things around: their channels, with `_repulsive` where one stands twice."""
    names: list[str] = []
    for kind in play.scene.around:
        names.append(f"{kind.channel}_repulsive" if kind.channel in names else kind.channel)
    return names


ComponentNames = Callable[[Play], Sequence[str]]
SeeTerm = Callable[[Play, GoalObservation], Floats]
TERMS_OF_GOALS: dict[str, tuple[ComponentNames, SeeTerm]] = {
    "command": (lambda _: ("command_ahead", "command_left"), see_command),
    "around": (lambda play: [f"{kind}_{part}" for kind in kinds_of(play) for part in WAY], see_around),
    "neighbour": (lambda _: ("neighbours", *(f"neighbour_{part}" for part in WAY[1:])), see_neighbour),
    "movement": (lambda _: ("speed", "turn_rate"), see_movement),
    "facts": (lambda play: play.facts, see_facts),
    "time": (lambda _: ("time_left",), see_time),
    "holds": (lambda play: [f"holds_{option}" for option in play.team.options], see_holds),
}
"""Name of a term -> the names of its components, and the function that returns them (R, K)."""

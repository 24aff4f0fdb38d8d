"""Draws the pictures of selforg: `python -m docs.figures.draw_selforg [DIR]` (default docs/pictures)."""

import sys
from io import BytesIO
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from PIL import Image

from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, MovementMechanism
from selforg.randomness import DirectionStream
from selforg.space import Euclidean

SIZE, PROBES = 4.0, 21  # half the side of a field [m], arrows along a side
ATTRACTIVE, REPULSIVE, INK, PALE = "#009E73", "#D55E00", "#1b2a41", "#8d99ae"
COLOURS = {1: ATTRACTIVE, -1: REPULSIVE}
AMONG_ROBOTS = ("RepulsionFernandez", "RepulsionGradient", "Flocking", "FlockingReynolds")

SCENES = {
    "one": (Gradient("here", (0.0, 0.0), attraction=1, diffusion=2.0, goal_radius=0.5),),
    "two": (
        Gradient("here", (-1.5, 0.0), attraction=1, diffusion=2.0, goal_radius=0.5),
        Gradient("here", (1.5, 0.5), attraction=-1, diffusion=1.5, goal_radius=0.5),
    ),
}


def field(name: str, gradients: tuple[Gradient, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return places (P, 2), vectors (P, 2) and whether there is one (P,): every probe is a team of its own."""
    side = np.linspace(-SIZE, SIZE, PROBES)
    places = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    rows, space = len(places), Euclidean(2)
    poses = OwnPoses(space, rows, np.arange(rows), goal_radius=0.25)
    buffer = SoBuffer(BufferSettings(view_distance=2.5, aggregation_distance=0.0), space, poses)
    for stamp in (0.0, 1.0):  # two poses each: flocking needs velocities
        poses.update(places - [0.2 * (1.0 - stamp), 0.0], np.zeros(rows), stamp)
        for team in range(rows):
            for index, g in enumerate(gradients):
                moving = name in AMONG_ROBOTS
                channel = poses.channel if moving else g.channel
                position = (g.position[0], g.position[1] - 0.2 * (1.0 - stamp)) if moving else g.position
                copy = Gradient(channel, position, f"source {index}", (0.0, 1.0), g.attraction, g.diffusion,
                                g.goal_radius, stamp=stamp, moving=moving)  # fmt: skip
                buffer.store(copy, stamp, team=team)
    generators = [np.random.default_rng((7, row)) for row in range(rows)]
    mechanism = MECHANISMS.create(name, buffer, directions=DirectionStream(generators))
    vectors, active = mechanism.move(1.0)
    return places, vectors, active


def draw_fields(scene: str) -> Figure:
    """Return one panel per movement mechanism."""
    names = [cls.__name__ for cls in MECHANISMS if issubclass(cls, MovementMechanism)]
    columns = 5
    lines = -(-len(names) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(2.9 * columns, 3.05 * lines), layout="constrained")
    for axis, name in zip(axes.flat, names, strict=False):
        draw_field(axis, name, SCENES[scene])
    for axis in axes.flat[len(names) :]:
        axis.axis("off")
    figure.suptitle(
        f"Where each mechanism takes a robot around {scene} gradient{'' if scene == 'one' else 's'}\n"
        "green attracts, orange repels; filled: goal area, dashed: reach; arrows scaled per panel, darker = longer",
        fontsize=11, color=INK,
    )  # fmt: skip
    return figure


def draw_field(axis: Axes, name: str, gradients: tuple[Gradient, ...]) -> None:
    """Draw the vectors of one mechanism and the gradients that cause them."""
    places, vectors, active = field(name, gradients)
    for g in gradients:
        axis.add_patch(Circle(g.position, g.reach, fill=False, ls="--", lw=0.9, ec=COLOURS[g.attraction]))
        axis.add_patch(Circle(g.position, g.goal_radius, fc=COLOURS[g.attraction], alpha=0.45, lw=0))
    lengths = np.linalg.norm(vectors, axis=1)
    shown = active & (lengths > 0)
    spacing = 2 * SIZE / (PROBES - 1)
    if shown.any():
        arrows = vectors[shown] / lengths[shown, None] * (0.35 + 0.6 * lengths[shown, None] / lengths.max()) * spacing
        axis.quiver(*places[shown].T, *arrows.T, lengths[shown], cmap="Blues", angles="xy", scale_units="xy", scale=1.0,
                    width=0.007, clim=(-0.6 * lengths.max(), lengths.max()), pivot="mid")  # fmt: skip
    still = active & (lengths == 0)
    axis.plot(*places[still].T, ".", ms=1.5, color=PALE)
    among = " (among robots)" if name in AMONG_ROBOTS else ""
    axis.set_title(name + among, fontsize=8, color=INK)
    axis.set(xlim=(-SIZE - 0.2, SIZE + 0.2), ylim=(-SIZE - 0.2, SIZE + 0.2), aspect="equal", xticks=[], yticks=[])
    for spine in axis.spines.values():
        spine.set_color("#d9dee6")


def draw_evaporation_and_aggregation() -> Figure:
    """Return how diffusion falls with time, and what the aggregation rules leave of two gradients."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4), layout="constrained")
    times = np.arange(0.0, 20.01, 0.05)
    for whole, style, label in ((False, "-", "exact time"), (True, "--", "whole seconds (the original)")):
        buffer = lone_buffer(BufferSettings(view_distance=np.inf, whole_seconds=whole))
        buffer.store(Gradient("f", (0.0, 0.0), diffusion=4.0, evaporation_factor=0.8, evaporation_period=1.5), 0.0)
        seen = [Queries(buffer).gradients(0, float(t)) for t in times]
        left.plot(
            times, [s[0].diffusion if s else 0.0 for s in seen], style, color=INK if whole else REPULSIVE, label=label
        )
    left.axhline(0.1, color=PALE, lw=0.8)
    left.text(0.2, 0.16, "min_diffusion: deleted below", fontsize=8, color=PALE)
    left.set(xlabel="time [s]", ylabel="diffusion [m]", title="Evaporation: factor 0.8 every 1.5 s", ylim=(0, None))
    left.legend(frameon=False)
    rules = ("max", "min", "average", "new")
    for index, rule in enumerate(rules):
        buffer = lone_buffer(
            BufferSettings(view_distance=np.inf, aggregation={"DEFAULT": rule}, aggregation_distance=1.0)
        )
        x = 4.5 * index
        pair = (
            Gradient("f", (x - 0.4, 0.0), diffusion=1.6, stamp=0.0),
            Gradient("f", (x + 0.4, 0.0), diffusion=0.9, stamp=1.0),
        )
        for g in pair:
            right.add_patch(Circle((g.position[0], 2.4), g.diffusion, fill=False, ec=PALE, lw=1.0))
            right.plot(g.position[0], 2.4, "+", color=PALE)
            buffer.store(g, g.stamp)
        for g in Queries(buffer).gradients(0, 1.0, Filter()):
            right.add_patch(Circle((g.position[0], -1.6), g.diffusion, fc=ATTRACTIVE, alpha=0.25, ec=ATTRACTIVE))
            right.plot(g.position[0], -1.6, "+", color=INK)
        right.text(x, 4.4, rule, ha="center", color=INK)
    right.text(-2.4, 2.4, "stored,\nthen new", fontsize=8, color=INK, ha="right", va="center")
    right.text(-2.4, -1.6, "left", fontsize=8, color=INK, ha="right", va="center")
    right.set(xlim=(-4.5, 16), ylim=(-3.6, 5), aspect="equal", title="Aggregation of two gradients 0.8 m apart")
    right.axis("off")
    return figure


def lone_buffer(settings: BufferSettings) -> SoBuffer:
    """Return a buffer of one robot at the origin."""
    space = Euclidean(2)
    poses = OwnPoses(space, 1)
    poses.update(np.zeros((1, 2)), None, 0.0)
    return SoBuffer(settings, space, poses)


def main(directory: Path) -> None:
    """Draw all pictures into a directory."""
    directory.mkdir(parents=True, exist_ok=True)
    figures = {
        "fields_one": draw_fields("one"),
        "fields_two": draw_fields("two"),
        "evaporation_aggregation": draw_evaporation_and_aggregation(),
    }
    for name, figure in figures.items():
        drawn = BytesIO()
        figure.savefig(drawn, dpi=110)
        picture = Image.open(drawn).convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2)
        picture.save(directory / f"{name}.png", optimize=True)
        plt.close(figure)
        print(directory / f"{name}.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "pictures")

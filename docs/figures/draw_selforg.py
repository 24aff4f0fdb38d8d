"""Draws where each mechanism takes a robot: `python -m docs.figures.draw_selforg [DIR]` (default docs/pictures)."""

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
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, MovementMechanism
from selforg.mechanisms.weighted_sum import WeightedSum
from selforg.randomness import DirectionStream
from selforg.space import Euclidean

SIZE, PROBES = 4.0, 21  # half the side of a field [m], arrows along a side
ATTRACTIVE, REPULSIVE, INK, PALE = "#009E73", "#D55E00", "#1b2a41", "#8d99ae"
COLOURS = {1: ATTRACTIVE, -1: REPULSIVE}
AMONG_ROBOTS = ("RepulsionFernandez", "RepulsionGradient", "Flocking", "FlockingReynolds")

ONLY_REPELLED = ("CollisionAvoidance",)  # an attractive gradient does nothing to these


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
    mechanism = MECHANISMS.find(name)(buffer, directions=DirectionStream(generators))
    vectors, active = mechanism.move(1.0)
    return places, vectors, active


def draw_fields() -> Figure:
    """Return one panel per movement mechanism."""
    names = [cls.__name__ for cls in MECHANISMS if issubclass(cls, MovementMechanism) and cls is not WeightedSum]
    columns = 4
    lines = -(-len(names) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(2.9 * columns, 3.05 * lines), layout="constrained")
    for axis, name in zip(axes.flat, names, strict=False):
        attraction = -1 if name in ONLY_REPELLED else 1
        draw_field(axis, name, (Gradient("here", (0.0, 0.0), attraction=attraction, diffusion=2.0, goal_radius=0.5),))
    for axis in axes.flat[len(names) :]:
        axis.axis("off")
    figure.suptitle(
        "Where each mechanism takes a robot around one gradient\n"
        "green attracts, orange repels; filled: goal area, dashed: reach; arrows scaled per panel, darker = longer",
        fontsize=13, color=INK,
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
    axis.set_title(name + among, fontsize=10, color=INK)
    axis.set(xlim=(-SIZE - 0.2, SIZE + 0.2), ylim=(-SIZE - 0.2, SIZE + 0.2), aspect="equal", xticks=[], yticks=[])
    for spine in axis.spines.values():
        spine.set_color("#d9dee6")


def main(directory: Path) -> None:
    """Draw the picture into a directory."""
    directory.mkdir(parents=True, exist_ok=True)
    figure, drawn = draw_fields(), BytesIO()
    figure.savefig(drawn, dpi=110)
    picture = Image.open(drawn).convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2)
    picture.save(directory / "fields_one.png", optimize=True)
    print(directory / "fields_one.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "pictures")

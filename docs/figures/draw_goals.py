"""Draws every goal in its scene, small multiples of one run each: `python -m docs.figures.draw_goals [FILE]`."""

import sys
from itertools import product
from pathlib import Path
from textwrap import fill

import matplotlib.pyplot as plt
import numpy as np
from clean_swarm_env.scenes.measures.agreement import in_earshot
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from clean_swarm_env.scenes import Scene, find, goals
from clean_swarm_env.scenes.scene import Run
from clean_swarm_env.scenes.served import ServedTeam, expertise
from selforg.arrays import Floats

FILE, SEED, COLUMNS = Path(__file__).parents[1] / "pictures" / "goals.png", 0, 5
INK, PAPER = "#2b2b2b", "#fbfaf7"
TRACK, ATTRACTIVE, REPULSIVE, CHOSEN = "#0072B2", "#009E73", "#D55E00", "#E69F00"
MOST_SHOWN = 6.0
"""Reach up to which the diffusion of a gradient is drawn [m]; beyond, it covers everything."""
LAST = 60
"""Control periods at the end that are shown of a group on land where nothing lies around."""
AROUND = 1.5
"""Space around the tracks on open land [m]."""


def draw_goal(axes: Axes, goal: str) -> None:
    """Run a goal once by its best option and draw what lies around, the tracks and where the robots end."""
    kind = find(goal)
    expert = expertise(goal)
    scene = kind(kind.setting, [SEED])
    run = scene.run(lambda made: ServedTeam(made, expert))
    draw_things(axes, scene)
    draw_tracks(axes, scene, run)
    draw_decisions(axes, scene)
    draw_robots(axes, scene)
    first = kind.measures[0]
    unit = "" if first.unit == "-" else f" {first.unit}"
    value = float(run.values[first.name][0])
    axes.set_title(f"{goal}\n{expert.name}", fontsize=9, color=INK)
    below = fill(f"{first.name}: {value:.3g}{unit}", 36)
    axes.text(0.5, -0.03, below, transform=axes.transAxes, ha="center", va="top", fontsize=8, color=INK)
    frame(axes, scene, run)


def draw_things(axes: Axes, scene: Scene) -> None:
    """Draw gradients that lie around: their goal areas, and their reach where it is not the whole ground."""
    for kind in scene.around:
        colour = ATTRACTIVE if kind.attraction > 0 else REPULSIVE
        count = kind.places.shape[1]
        each = zip(kind.places[0], np.broadcast_to(kind.diffusion, count), np.broadcast_to(kind.goal_radius, count),
                   strict=True)  # fmt: skip
        for place, diffusion, goal_radius in each:
            reach = float(diffusion + goal_radius)
            for image in images(scene, place):
                if reach <= MOST_SHOWN:
                    axes.add_patch(Circle(image, reach, fc=colour, alpha=0.12, ec="none", zorder=0))
                core = Circle(image, max(float(goal_radius), 0.1), fc=colour, alpha=0.45, ec=colour, zorder=1)
                axes.add_patch(core)


def images(scene: Scene, place: Floats) -> list[Floats]:
    """Return where a place (2,) [m] appears: on a torus beyond the seams too, which the frame cuts off."""
    if scene.ground.kind == "open":
        return [place]
    return [place + scene.ground.side * np.array(step) for step in product((-1, 0, 1), repeat=2)]


def draw_tracks(axes: Axes, scene: Scene, run: Run) -> None:
    """Draw tracks that fade into the past; a step across the seam is left out."""
    fade = np.linspace(0.08, 0.7, len(run.tracks) - 1)
    for track in np.moveaxis(run.tracks, 1, 0):
        steps = np.stack([track[:-1], track[1:]], axis=1)
        kept = np.abs(steps[:, 1] - steps[:, 0]).max(axis=1) < 0.5 * scene.ground.side
        axes.add_collection(LineCollection(list(steps[kept]), colors=TRACK, alpha=fade[kept], linewidths=0.8, zorder=2))


def draw_decisions(axes: Axes, scene: Scene) -> None:
    """Draw who was elected, and who hears whom."""
    places = scene.positions[0]
    if scene.goal == "MaxValue":
        for a, b in np.argwhere(np.triu(in_earshot(scene.positions, 3.0, scene.ground)[0])):
            axes.plot(*places[[a, b]].T, color=INK, alpha=0.25, linewidth=0.7, zorder=1)
    if scene.goal == "FindBarycenter":
        assert isinstance(scene.controller, ServedTeam)
        elected = places[scene.controller.decisions()[1] == 1]
        axes.plot(*places.mean(axis=0), "+", color=INK, markersize=9, zorder=6)
        axes.scatter(*elected.T, s=120, facecolor="none", edgecolor=CHOSEN, linewidth=2.0, zorder=6)


def draw_robots(axes: Axes, scene: Scene) -> None:
    """Draw where everybody is at the end, and looks to; by value where there is one."""
    places, headings, radius = scene.positions[0], scene.headings[0], scene.body.radius
    values = scene.known.get("measured")
    for row, (place, heading) in enumerate(zip(places, headings, strict=True)):
        colour = TRACK if values is None else plt.get_cmap("viridis")(float(np.asarray(values)[row]) / 100.0)
        for image in images(scene, place):
            axes.add_patch(Circle(image, radius, fc=colour, ec="white", linewidth=0.5, zorder=4))
        nose = place + radius * np.array([np.cos(heading), np.sin(heading)])
        axes.plot(*np.stack([place, nose]).T, color="white", linewidth=0.8, zorder=5)


def frame(axes: Axes, scene: Scene, run: Run) -> None:
    """Show the whole torus, or what of open land is used, with a ruler of one metre."""
    ground = scene.ground
    if ground.kind == "torus":
        low, high = np.zeros(2), np.full(2, ground.side)
    else:
        # A group that leaves for good is shown where it ends, all others with their whole way.
        shown = run.tracks if scene.around else run.tracks[-LAST:]
        corners = np.concatenate([shown.reshape(-1, 2), *(g.places[0] for g in scene.around)])
        middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        half = 0.5 * np.ptp(corners, axis=0).max() + AROUND
        low, high = middle - half, middle + half
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xticks=[], yticks=[], facecolor=PAPER)
    for spine in axes.spines.values():  # dashed: the seam of a torus; none: open land
        spine.set(color=INK, linestyle=(0, (6, 4)), linewidth=0.9, visible=ground.kind == "torus")
    x, y = low + 0.03 * (high - low)
    axes.plot([x, x + 1.0], [y, y], color=INK, linewidth=2.0, solid_capstyle="butt", zorder=7)


def draw_all() -> Figure:
    """Return the picture of all goals."""
    names = goals()
    lines = -(-len(names) // COLUMNS)
    figure, grid = plt.subplots(lines, COLUMNS, figsize=(3.0 * COLUMNS, 3.7 * lines))
    figure.subplots_adjust(left=0.01, right=0.99, top=0.95, bottom=0.05, wspace=0.06, hspace=0.34)
    for axes, goal in zip(grid.flat, names, strict=False):
        draw_goal(axes, goal)
    spare = list(grid.flat)[len(names) :]
    for axes in spare:
        axes.axis("off")
    draw_legend(spare[0] if spare else grid.flat[-1])
    return figure


def draw_legend(axes: Axes) -> None:
    """Explain the signs."""
    entries = (("robot at the end, its track", TRACK, 1.0), ("attracts", ATTRACTIVE, 0.5), ("repels", REPULSIVE, 0.5))
    for line, (text, colour, alpha) in enumerate(entries):
        axes.plot(0.1, 0.85 - 0.12 * line, "o", color=colour, alpha=alpha, markersize=10)
        axes.text(0.2, 0.85 - 0.12 * line, text, va="center", fontsize=9, color=INK)
    more = (
        "dashed frame: a torus; none: open land\nblack bar: 1 m\norange ring: robot elected, +: barycentre\n"
        "grey lines: who hears whom\ndark to yellow: small to large values"
    )
    axes.text(0.06, 0.42, more, va="top", fontsize=8, color=INK, linespacing=1.6)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))


def main() -> None:
    """Draw and save."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    draw_all().savefig(file, dpi=80)
    print(file)


if __name__ == "__main__":
    main()

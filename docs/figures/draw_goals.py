"""Draws every task, small multiples of one run each: `python -m docs.figures.draw_goals [FILE]`."""

import sys
from itertools import product
from pathlib import Path
from textwrap import fill

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from PIL.Image import Image
from PIL.Image import open as open_picture

from clean_swarm_env.config.task_names import task_names
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import Task, TaskView
from clean_swarm_env.tasks.measures.agreement import in_earshot
from selforg.arrays import Floats

FILE, SEED, COLUMNS = Path(__file__).parents[1] / "pictures" / "goals.png", 0, 5
INK, PAPER = "#2b2b2b", "#fbfaf7"
TRACK, ATTRACTIVE, REPULSIVE, CHOSEN = "#0072B2", "#009E73", "#D55E00", "#E69F00"
MOST_SHOWN = 6.0
"""Reach up to which the diffusion of a gradient is drawn [m]; beyond, it covers everything."""
TOP, BOTTOM, GAP = 0.95, 0.05, 0.34
"""Upper and lower edge of the panels, as shares of the picture; gap between lines of them, in heights of a panel."""
ABOVE, BELOW = 0.048, 0.036
"""Room for the text above and below a panel, as shares of the picture."""
LAST = 60
"""Control periods at the end that are shown of a group on land where nothing lies around."""
AROUND = 1.5
"""Space around the tracks on open land [m]."""


def tasks_to_run() -> list[str]:
    """Return the names of all tasks that have a baseline."""
    return [name for name in task_names() if find_task(name).baseline]


def draw_task(axes: Axes, name: str) -> None:
    """Do a task once by its best option; draw what lies around, the tracks and where the robots end."""
    batch = Batch(name, begin_anew=False)
    batch.reset([SEED])
    default, tracks = np.tile(batch.choices.default, (batch.rows, 1)), [batch.worlds.physics.positions.copy()]
    while not batch.over.all():
        for worlds in batch.ticks(default):
            tracks.append(worlds.physics.positions.copy())
        batch.end_period()
    task, ways = batch.worlds.task, np.stack(tracks)
    draw_things(axes, task)
    draw_tracks(axes, task.world, ways)
    draw_decisions(axes, task)
    draw_robots(axes, task)
    first = task.measures[0]
    unit = "" if first.unit == "-" else f" {first.unit}"
    value = float(task.result()[first.name][0])
    option = next(iter(batch.options.values()))[int(batch.choices.default[0])]
    axes.set_title(f"{name}\n{option}", fontsize=9, color=INK)
    below = fill(f"{first.name}: {value:.3g}{unit}", 36)
    axes.text(0.5, -0.03, below, transform=axes.transAxes, ha="center", va="top", fontsize=8, color=INK)
    frame(axes, task, ways)


def draw_things(axes: Axes, task: Task) -> None:
    """Draw gradients that lie around: their goal areas, and their reach where it is not the whole ground."""
    for kind in task.around:
        colour = ATTRACTIVE if kind.attraction > 0 else REPULSIVE
        count = kind.places.shape[1]
        each = zip(kind.places[0], np.broadcast_to(kind.diffusion, count), np.broadcast_to(kind.goal_radius, count),
                   strict=True)  # fmt: skip
        for place, diffusion, goal_radius in each:
            reach = float(diffusion + goal_radius)
            for image in images(task.world, place):
                if reach <= MOST_SHOWN:
                    axes.add_patch(Circle(image, reach, fc=colour, alpha=0.12, ec="none", zorder=0))
                core = Circle(image, max(float(goal_radius), 0.1), fc=colour, alpha=0.45, ec=colour, zorder=1)
                axes.add_patch(core)


def images(world: TaskView, place: Floats) -> list[Floats]:
    """Return where a place (2,) [m] appears: on a torus beyond the seams too, which the frame cuts off."""
    if world.ground.kind == "open":
        return [place]
    return [place + world.ground.size * np.array(step) for step in product((-1, 0, 1), repeat=2)]


def draw_tracks(axes: Axes, world: TaskView, tracks: Floats) -> None:
    """Draw tracks that fade into the past; a step across the seam is left out."""
    fade = np.linspace(0.08, 0.7, len(tracks) - 1)
    for track in np.moveaxis(tracks, 1, 0):
        steps = np.stack([track[:-1], track[1:]], axis=1)
        kept = np.abs(steps[:, 1] - steps[:, 0]).max(axis=1) < 0.5 * world.ground.extent.min()
        axes.add_collection(LineCollection(list(steps[kept]), colors=TRACK, alpha=fade[kept], linewidths=0.8, zorder=2))


def draw_decisions(axes: Axes, task: Task) -> None:
    """Draw who was elected, and who hears whom."""
    world, places = task.world, task.world.positions[0]
    if task.name == "MaxValue":
        for a, b in np.argwhere(np.triu(in_earshot(world.positions, 3.0, world.ground)[0])):
            axes.plot(*places[[a, b]].T, color=INK, alpha=0.25, linewidth=0.7, zorder=1)
    if task.name == "FindBarycenter":
        elected = places[world.decisions()[1][0] == 1]
        axes.plot(*places.mean(axis=0), "+", color=INK, markersize=9, zorder=6)
        axes.scatter(*elected.T, s=120, facecolor="none", edgecolor=CHOSEN, linewidth=2.0, zorder=6)


def draw_robots(axes: Axes, task: Task) -> None:
    """Draw where everybody is at the end, and looks to; by value where there is one."""
    world = task.world
    places, headings, radius = world.positions[0], world.headings[0], world.mission.robots.radius
    values = task.known().get("measured")
    for row, (place, heading) in enumerate(zip(places, headings, strict=True)):
        colour = TRACK if values is None else plt.get_cmap("viridis")(float(np.asarray(values)[row]) / 100.0)
        for image in images(world, place):
            axes.add_patch(Circle(image, radius, fc=colour, ec="white", linewidth=0.5, zorder=4))
        nose = place + radius * np.array([np.cos(heading), np.sin(heading)])
        axes.plot(*np.stack([place, nose]).T, color="white", linewidth=0.8, zorder=5)


def frame(axes: Axes, task: Task, tracks: Floats) -> None:
    """Show the whole torus, or what of open land is used, with a ruler of one metre."""
    ground = task.world.ground
    if ground.kind == "torus":
        low, high = np.zeros(2), ground.size
    else:
        # A group that leaves for good is shown where it ends, all others with their whole way.
        shown = tracks if task.around else tracks[-LAST:]
        corners = np.concatenate([shown.reshape(-1, 2), *(g.places[0] for g in task.around)])
        middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        half = 0.5 * np.ptp(corners, axis=0).max() + AROUND
        low, high = middle - half, middle + half
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xticks=[], yticks=[], facecolor=PAPER)
    for spine in axes.spines.values():  # dashed: the seam of a torus; none: open land
        spine.set(color=INK, linestyle=(0, (6, 4)), linewidth=0.9, visible=ground.kind == "torus")
    x, y = low + 0.03 * (high - low)
    axes.plot([x, x + 1.0], [y, y], color=INK, linewidth=2.0, solid_capstyle="butt", zorder=7)


def draw_all() -> Figure:
    """Return the picture of all tasks."""
    names = tasks_to_run()
    lines = -(-len(names) // COLUMNS)
    figure, grid = plt.subplots(lines, COLUMNS, figsize=(3.0 * COLUMNS, 3.7 * lines))
    figure.subplots_adjust(left=0.01, right=0.99, top=TOP, bottom=BOTTOM, wspace=0.06, hspace=GAP)
    for axes, name in zip(grid.flat, names, strict=False):
        draw_task(axes, name)
    spare = list(grid.flat)[len(names) :]
    for axes in spare:
        axes.axis("off")
    draw_legend(spare[0] if spare else grid.flat[-1])
    return figure


def cut_out(name: str) -> Image:
    """Return the panel of one task from the picture of all, with the text above and below it."""
    names, picture = tasks_to_run(), open_picture(FILE)
    lines = -(-len(names) // COLUMNS)
    line, column = divmod(names.index(name), COLUMNS)
    height = (TOP - BOTTOM) / (lines + (lines - 1) * GAP)
    top = 1.0 - TOP + line * height * (1.0 + GAP)
    shares = (column / COLUMNS, top - ABOVE, (column + 1) / COLUMNS, top + height + BELOW)
    box = (round(share * side) for share, side in zip(shares, picture.size * 2, strict=True))
    return picture.crop(tuple(box))


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

"""Fig. 5 of the paper: the ways of the robots in a mission, coloured by their cargo, and how far they sense."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.drawing.canvas import NOTHING, Canvas, SignedThings, appearances
from clean_swarm_env.drawing.canvases import canvas_of
from clean_swarm_env.drawing.look import LOOK
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.knowledge import load_knowledge

MISSION, OPTION, SECONDS, SEED = "table1", "RepulsionGradient-view1.5", 90.0, 14
CARGO = {NOTHING: "#8a8a8a", 0: "#7B4B94", 1: "#E69F00"}
"""Grey without cargo, purple with an item for the recycling station, orange with leftovers for the dump."""
ITEM = {"ls": "none", "marker": "D", "ms": 8, "color": "#009E73", "markeredgecolor": LOOK.ink}
"""Look of an item of garbage."""
NAMES = {NOTHING: "without cargo", 0: "to recycling", 1: "to the dump"}
"""Cargo in words."""


def draw_trajectories() -> Figure:
    """Return the world at the end, with the way of every robot up to then."""
    mission = load_mission(MISSION)
    scenes = list(courses())
    last, garbage_sight = scenes[-1], mission.task.garbage.diffusion + mission.task.garbage.view_distance
    figure = Figure(figsize=(8.2, 8.9), facecolor="white")
    axes = figure.add_axes((0.02, 0.09, 0.96, 0.87))
    axes.set(
        xlim=(0.0, last.width), ylim=(0.0, last.height), aspect="equal", xticks=[], yticks=[], facecolor=LOOK.paper
    )
    for spine in axes.spines.values():
        spine.set(color=LOOK.ink, linestyle=(0, (6, 4)), linewidth=1.0)
    for load, station in enumerate(last.signs[:2]):
        draw_station(axes, last, station, CARGO[load])
    axes.plot(*scenes[0].signs[2].places.T, **ITEM, zorder=4)
    draw_ways(axes, scenes)
    pose_reach = mission.robots.pose_goal_radius + mission.robots.pose_diffusion
    draw_ends(axes, last, garbage_sight, pose_reach)
    draw_ruler(axes, last)
    axes.set_title(f"{OPTION}, the first {SECONDS:g} s of a mission; garbage where it lay", fontsize=11, color=LOOK.ink)
    figure.legend(
        handles=list(signs(garbage_sight, pose_reach)), loc="lower center", ncols=3, frameon=False, fontsize=9
    )
    return figure


def courses() -> Iterator[Canvas]:
    """Yield what there is to see, control period by control period, but for pheromones."""
    mission = load_mission(MISSION)
    model = CoordinatorModel(AVOIDANCE, load_knowledge(mission.knowledge), Library())
    worlds = Worlds(mission, model)
    worlds.reset(0, random_start(mission, SEED, 0), SEED)
    worlds.hold(np.full(worlds.rows, model.options.index(OPTION)))
    for _ in range(round(SECONDS / worlds.period)):
        worlds.tick()
        yield replace(canvas_of(worlds, 0), pheromones=np.zeros((0, 2)), pheromone_diffusions=np.zeros(0))


def draw_ways(axes: Axes, scenes: list[Canvas]) -> None:
    """Draw a line for each robot and period in the colour of its cargo; steps across a seam are left out."""
    places = np.stack([scene.positions for scene in scenes])
    cargo = np.stack([scene.load for scene in scenes if scene.load is not None])
    steps = np.stack([places[:-1], places[1:]], axis=2)
    near = np.abs(steps[:, :, 1] - steps[:, :, 0]).max(axis=-1) < 0.5 * min(scenes[0].width, scenes[0].height)
    for load, colour in CARGO.items():
        chosen = near & (cargo[1:] == load)
        axes.add_collection(
            LineCollection(list(steps[chosen]), colors=colour, linewidths=1.8, zorder=2.5, capstyle="round")
        )


def draw_ends(axes: Axes, scene: Canvas, garbage_sight: float, reach: float) -> None:
    """Draw the robots where they end, how far they see garbage, and the reach of their pose gradients."""
    cargo = np.full(len(scene.positions), NOTHING) if scene.load is None else scene.load
    for place, heading, load in zip(scene.positions, scene.headings, cargo, strict=True):
        colour = CARGO[int(load)]
        for x, y in appearances(scene, place[None], garbage_sight)[1]:
            axes.add_patch(Circle((x, y), garbage_sight, fill=False, ec=LOOK.ink, ls=(0, (2, 3)), lw=0.9, zorder=3))
            axes.add_patch(Circle((x, y), reach, fc=colour, alpha=0.12, ec="none", zorder=2))
            axes.add_patch(Circle((x, y), scene.radius, fc=colour, ec="white", lw=1.2, zorder=6))
            nose = scene.radius * np.array([np.cos(heading), np.sin(heading)])
            axes.plot([x, x + nose[0]], [y, y + nose[1]], color="white", linewidth=2.0, zorder=7)


def signs(garbage_sight: float, reach: float) -> Iterator[Line2D]:
    """Yield the entries of the legend."""
    for load, colour in CARGO.items():
        yield Line2D([], [], color=colour, linewidth=2.5, label=f"way {NAMES[load]}")
    yield Line2D([], [], **ITEM, label="garbage at the start")
    yield Line2D([], [], color=LOOK.ink, ls=(0, (2, 3)), lw=0.9, label=f"sees garbage, {garbage_sight:g} m")
    yield Line2D(
        [], [], ls="none", marker="o", ms=11, color="#8a8a8a", alpha=0.3, label=f"reach of its pose, {reach:g} m"
    )


def draw_station(axes: Axes, scene: Canvas, station: SignedThings, colour: str) -> None:
    """Draw a station as a rounded square with its name, and the circle in which a robot is there (dotted)."""
    name, places, radius = station
    for x, y in appearances(scene, places, radius)[1]:
        half = 0.55 * radius
        axes.add_patch(Circle((x, y), radius, facecolor=colour, edgecolor="none", alpha=0.12, zorder=1))
        axes.add_patch(Circle((x, y), radius, fill=False, edgecolor=colour, linestyle=":", linewidth=1.3, zorder=3))
        box = FancyBboxPatch((x - half, y - half), 2 * half, 2 * half, boxstyle="round,pad=0,rounding_size=0.08")
        box.set(facecolor=colour, edgecolor="white", linewidth=1.0, zorder=3)
        axes.add_patch(box)
        axes.text(x, y, name[0].upper(), color="white", fontsize=10, weight="bold", ha="center", va="center", zorder=3)
        axes.text(x, y - radius - 0.06, name, color=colour, fontsize=8, ha="center", va="top", zorder=3)


def draw_ruler(axes: Axes, scene: Canvas) -> None:
    """Draw one metre in the lower left corner."""
    left, low = 0.03 * scene.width, 0.025 * scene.height
    axes.plot([left, left + 1.0], [low, low], color=LOOK.ink, linewidth=2.0, solid_capstyle="butt", zorder=8)
    axes.text(left + 0.5, low + 0.06, "1 m", color=LOOK.ink, fontsize=8, ha="center", va="bottom", zorder=8)

"""A picture of the world: robots with their gradients, garbage, stations and the pheromone trail, on the torus.

The functions take plain arrays and return a Matplotlib figure; they do not depend on the mission. The colours are those
of Okabe and Ito, which colour-blind readers can tell apart; shapes differ too.
Shapes: N robots, G items of garbage, M pheromones.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyBboxPatch, Wedge
from numpy.typing import NDArray

SEARCHING: Final = 0  # values of `Canvas.cargo`: the robot carries nothing,
GARBAGE: Final = 1  # an item to the recycling station,
LEFTOVERS: Final = 2  # or its leftovers to the dump station

INK, PAPER = "#2b2b2b", "#fbfaf7"
ROBOT_COLOURS: Final = {SEARCHING: "#0072B2", GARBAGE: "#D55E00", LEFTOVERS: "#7B4B94"}
GARBAGE_COLOUR: Final = "#E69F00"
RECYCLING_COLOUR, DUMP_COLOUR = "#009E73", "#7B4B94"
TRAIL: Final = LinearSegmentedColormap.from_list("trail", [PAPER, "#cfe6f5", "#8cc3e6"])
TRAIL_PITCH: Final = 0.1  # [m] of the raster on which the trail is drawn


def no_places() -> NDArray[np.float64]:
    """Return no places: (0, 2)."""
    return np.zeros((0, 2))


@dataclass(frozen=True)
class Canvas:
    """The data of a picture. Arrays of another shape than stated raise ValueError."""

    positions: NDArray[np.float64]  # (N, 2) [m] of the robots
    headings: NDArray[np.float64]  # (N,) [rad]
    recycling: tuple[float, float]  # [m]
    dump: tuple[float, float]  # [m]
    width: float = 11.0  # [m]
    height: float = 11.0  # [m]
    radius: float = 0.25  # [m] of a robot
    goal_radius: float = 0.5  # [m] of a robot's pose gradient
    diffusion: float = 1.0  # [m] of a robot's pose gradient
    station_radius: float = 0.5  # [m] within which a robot is at a station
    cargo: NDArray[np.int64] | None = None  # (N,) SEARCHING, GARBAGE or LEFTOVERS; None: all are searching
    garbage: NDArray[np.float64] = field(default_factory=no_places)  # (G, 2) [m] of items that lie
    pheromones: NDArray[np.float64] = field(default_factory=no_places)  # (M, 2) [m]
    pheromone_diffusions: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))  # (M,) [m]

    def __post_init__(self) -> None:
        robots, marks = len(self.positions), len(self.pheromones)
        shapes = {
            "positions": (robots, 2),
            "headings": (robots,),
            "garbage": (len(self.garbage), 2),
            "pheromones": (marks, 2),
            "pheromone_diffusions": (marks,),
        }
        if self.cargo is not None:
            shapes["cargo"] = (robots,)
        for name, shape in shapes.items():
            if np.shape(getattr(self, name)) != shape:
                raise ValueError(f"{name}: expected shape {shape}, got {np.shape(getattr(self, name))}")


def draw_world(canvas: Canvas, title: str = "", inches: float = 7.0) -> Figure:
    """Draw the canvas on a figure that is `inches` wide; save it with `figure.savefig(path)`.

    >>> canvas = Canvas(np.array([[0.1, 5.0]]), np.zeros(1), recycling=(2.75, 5.5), dump=(8.25, 5.5))
    >>> figure = draw_world(canvas, title="one robot on the seam")
    """
    side, under, above = 0.12, 0.62, 0.36 if title else 0.12  # [inch] margins: the legend is under the world
    tall = under + (inches - 2.0 * side) * canvas.height / canvas.width + above
    figure = Figure(figsize=(inches, tall), facecolor="white", dpi=150)
    axes = figure.add_axes((side / inches, under / tall, 1.0 - 2.0 * side / inches, 1.0 - (under + above) / tall))
    axes.set(xlim=(0.0, canvas.width), ylim=(0.0, canvas.height), aspect="equal", xticks=[], yticks=[], facecolor=PAPER)
    for spine in axes.spines.values():
        spine.set(color=INK, linestyle=(0, (6, 4)), linewidth=1.0)  # dashed: no wall
    if len(canvas.pheromones):
        # One cell more than the world on each side, so that smoothing does not show the seam.
        reach = (-TRAIL_PITCH, canvas.width + TRAIL_PITCH, -TRAIL_PITCH, canvas.height + TRAIL_PITCH)
        raster = np.pad(trail_strength(canvas), 1, mode="wrap")
        axes.imshow(raster, TRAIL, extent=reach, origin="lower", interpolation="bicubic", vmin=0.0, vmax=1.0, zorder=0)
        axes.set(xlim=(0.0, canvas.width), ylim=(0.0, canvas.height))
    draw_station(axes, canvas, canvas.recycling, RECYCLING_COLOUR, "recycling")
    draw_station(axes, canvas, canvas.dump, DUMP_COLOUR, "dump")
    for place in canvas.garbage:
        draw_item(axes, canvas, place, 0.11)
    cargo = np.zeros(len(canvas.positions), np.int64) if canvas.cargo is None else canvas.cargo
    for place, heading, load in zip(canvas.positions, canvas.headings, cargo, strict=True):
        draw_robot(axes, canvas, place, float(heading), int(load))
    draw_ruler(axes, canvas)
    draw_legend(figure, canvas)
    if title:
        axes.set_title(title, color=INK, fontsize=11, pad=6)
    return figure


def trail_strength(canvas: Canvas) -> NDArray[np.float64]:
    """Return the strength of the pheromones on a raster (rows upwards, columns to the right) of TRAIL_PITCH [m].

    In each cell the strongest pheromone counts. Its strength falls linearly from 1 at its centre to 0 at its diffusion
    radius, as Balch and Hybinette's repulsion does.
    """
    lines, columns = round(canvas.height / TRAIL_PITCH), round(canvas.width / TRAIL_PITCH)
    pitch = np.array([canvas.width / columns, canvas.height / lines])
    strength = np.zeros((lines, columns))
    for place, diffusion in zip(canvas.pheromones, canvas.pheromone_diffusions, strict=True):
        if diffusion <= 0.0:
            continue
        across, up = (int(cells) for cells in np.minimum(np.ceil(diffusion / pitch), (columns // 2, lines // 2)))
        centre = np.floor(place / pitch).astype(int)
        right, above = centre[0] + np.arange(-across, across + 1), centre[1] + np.arange(-up, up + 1)
        dx, dy = (right + 0.5) * pitch[0] - place[0], (above + 0.5) * pitch[1] - place[1]
        felt = 1.0 - np.hypot(dx[None, :], dy[:, None]) / diffusion
        patch = np.ix_(above % lines, right % columns)
        strength[patch] = np.maximum(strength[patch], felt)
    return strength


def draw_robot(axes: Axes, canvas: Canvas, place: NDArray[np.float64], heading: float, cargo: int) -> None:
    """Draw a disc with a bright front, its cargo, and the radii of its pose gradient (dashed: goal radius)."""
    colour = ROBOT_COLOURS[cargo]
    reach = canvas.goal_radius + canvas.diffusion
    for x, y in appearances(canvas, place, reach):
        axes.add_patch(Circle((x, y), reach, facecolor=colour, alpha=0.07, edgecolor="none", zorder=2))
        axes.add_patch(Circle((x, y), reach, fill=False, edgecolor=colour, alpha=0.45, linewidth=0.7, zorder=2))
        axes.add_patch(
            Circle(
                (x, y), canvas.goal_radius, fill=False, edgecolor=colour, linestyle=(0, (3, 3)), linewidth=0.8, zorder=2
            )
        )
        axes.add_patch(Circle((x, y), canvas.radius, facecolor=colour, edgecolor="white", linewidth=1.0, zorder=5))
        angle = np.degrees(heading)
        axes.add_patch(
            Wedge(
                (x, y), 0.92 * canvas.radius, angle - 24.0, angle + 24.0, facecolor="white", edgecolor="none", zorder=6
            )
        )
    if cargo != SEARCHING:
        behind = place - 0.35 * canvas.radius * np.array([np.cos(heading), np.sin(heading)])
        draw_item(axes, canvas, behind, (0.45 if cargo == GARBAGE else 0.3) * canvas.radius, zorder=7.0)


def draw_item(axes: Axes, canvas: Canvas, place: NDArray[np.float64], half: float, zorder: float = 4.0) -> None:
    """Draw an item of garbage as a diamond of `half` its height [m]."""
    for x, y in appearances(canvas, place, half):
        corners = [(x - half, y), (x, y + half), (x + half, y), (x, y - half)]
        axes.fill(*zip(*corners, strict=True), facecolor=GARBAGE_COLOUR, edgecolor=INK, linewidth=0.7, zorder=zorder)


def draw_station(axes: Axes, canvas: Canvas, place: tuple[float, float], colour: str, name: str) -> None:
    """Draw a station as a rounded square with its name, and the circle in which a robot is there (dotted)."""
    for x, y in appearances(canvas, np.array(place), canvas.station_radius):
        half = 0.55 * canvas.station_radius
        axes.add_patch(Circle((x, y), canvas.station_radius, facecolor=colour, edgecolor="none", alpha=0.12, zorder=1))
        axes.add_patch(
            Circle((x, y), canvas.station_radius, fill=False, edgecolor=colour, linestyle=":", linewidth=1.3, zorder=3)
        )
        box = FancyBboxPatch((x - half, y - half), 2 * half, 2 * half, boxstyle="round,pad=0,rounding_size=0.08")
        box.set(facecolor=colour, edgecolor="white", linewidth=1.0, zorder=3)
        axes.add_patch(box)
        axes.text(x, y, name[0].upper(), color="white", fontsize=10, weight="bold", ha="center", va="center", zorder=3)
        axes.text(x, y - canvas.station_radius - 0.06, name, color=colour, fontsize=8, ha="center", va="top", zorder=3)


def draw_ruler(axes: Axes, canvas: Canvas) -> None:
    """Draw one metre in the lower left corner."""
    left, low = 0.03 * canvas.width, 0.025 * canvas.height
    axes.plot([left, left + 1.0], [low, low], color=INK, linewidth=2.0, solid_capstyle="butt", zorder=8)
    axes.text(left + 0.5, low + 0.06, "1 m", color=INK, fontsize=8, ha="center", va="bottom", zorder=8)


def draw_legend(figure: Figure, canvas: Canvas) -> None:
    """Draw the legend under the world, with the signs that can occur in this canvas."""
    entries = [sign("o", ROBOT_COLOURS[SEARCHING], "white", "robot, searching")]
    if canvas.cargo is not None:
        entries.append(sign("o", ROBOT_COLOURS[GARBAGE], "white", "carrying garbage"))
        entries.append(sign("o", ROBOT_COLOURS[LEFTOVERS], "white", "carrying leftovers"))
    entries.append(sign("D", GARBAGE_COLOUR, INK, "garbage"))
    entries.append(Line2D([], [], color=ROBOT_COLOURS[SEARCHING], lw=0.8, linestyle=(0, (3, 3)), label="goal radius"))
    entries.append(Line2D([], [], color=ROBOT_COLOURS[SEARCHING], lw=0.8, alpha=0.6, label="reach of its gradient"))
    if len(canvas.pheromones):
        entries.append(Line2D([], [], color=TRAIL(1.0), lw=8, label="pheromones"))
    figure.legend(
        handles=entries, loc="lower center", ncols=(len(entries) + 1) // 2, frameon=False, fontsize=8, labelcolor=INK
    )


def sign(marker: str, colour: str, edge: str, label: str) -> Line2D:
    """Return an entry of the legend that is a single mark."""
    return Line2D(
        [], [], linestyle="none", marker=marker, markersize=7, color=colour, markeredgecolor=edge, label=label
    )


def appearances(canvas: Canvas, place: NDArray[np.float64], extent: float) -> Iterator[tuple[float, float]]:
    """Yield the places [m] at which a thing of half size `extent` [m] shows on the map: several at a seam."""
    for right, up in product((-1, 0, 1), repeat=2):
        x, y = float(place[0]) + right * canvas.width, float(place[1]) + up * canvas.height
        if -extent < x < canvas.width + extent and -extent < y < canvas.height + extent:
            yield x, y

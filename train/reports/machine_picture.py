"""The picture of a finite state machine: states on a circle, with their options, and arrows to those that follow."""

from __future__ import annotations

import textwrap
from collections import defaultdict

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch

from selector.strategies.machine_file import StateMachine, Transition
from selforg.arrays import Floats

STATE_RADIUS, RING = 0.82, 2.5
"""Radius of a state, and of the circle on which states stand [-]."""
BEND = 0.25
"""Bend of an arrow, so that the two between two states lie apart [-]."""
DARK, GREY, BORDER_OF_START = "#1b1b1b", "#6b6b6b", "#0072B2"


def draw_machine(machine: StateMachine) -> Figure:
    """Return the picture; the first state has a thick border, and numbers say in which order ways are tried."""
    names = list(machine.states)
    angles = np.pi / 2.0 + 2.0 * np.pi * np.arange(len(names)) / len(names)
    size = RING if len(names) > 1 else 0.0
    places = dict(zip(names, size * np.stack([np.cos(angles), np.sin(angles)], axis=1), strict=True))
    figure = Figure(figsize=(8.0, 7.5), facecolor="white", layout="constrained")
    axes = figure.add_subplot()
    reach = size + STATE_RADIUS + 0.6
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    axes.axis("off")
    axes.set_title(textwrap.fill(machine.description, 90), fontsize=10, color=DARK, parse_math=False)
    circles = {
        name: Circle(tuple(place), STATE_RADIUS, zorder=3, facecolor="#d4e9f7", linewidth=1.0, edgecolor=GREY)
        for name, place in places.items()
    }
    circles[machine.start].set(linewidth=3.0, edgecolor=BORDER_OF_START)
    for name, state in machine.states.items():
        axes.add_patch(circles[name])
        option = "\n".join(textwrap.wrap(state.option, 20))
        _write(axes, places[name] + np.array([0.0, 0.35]), name, "normal")
        _write(axes, places[name] - np.array([0.0, 0.1]), option, "bold")
        ways = defaultdict(list)
        for number, way in enumerate(state.transitions, start=1):
            ways[way.to].append(f"{number}: {way_text(way)}")
        for to, texts in ways.items():
            if to == name:
                x, y = places[name]  # the text stands away from the arrows, which lie inside the circle of states
                beside = np.array([1.2 * x, y + np.copysign(STATE_RADIUS + 0.25, y - 1.0)])
                _write(axes, beside, "\n".join([*texts, "stays"]), "normal")
            else:
                _draw_way(axes, circles[name], circles[to], "\n".join(texts))
    return figure


def way_text(way: Transition) -> str:
    """Return the condition of a transition in words.

    >>> way_text(Transition(to="b", when="crowd", above=0.25, probability=0.5))
    'crowd > 0.25, p 0.5'

    """
    bounds = [
        f"{way.when} {sign} {bound:g}" for sign, bound in ((">", way.above), ("<", way.below)) if bound is not None
    ]
    return ", ".join(bounds if bounds and way.probability == 1.0 else [*bounds, f"p {way.probability:g}"])


def _draw_way(axes: Axes, start: Circle, end: Circle, text: str) -> None:
    """Draw a bent arrow from a state to another, with its conditions."""
    first, last = np.array(start.center), np.array(end.center)
    axes.add_patch(FancyArrowPatch(
        start.center, end.center, connectionstyle=f"arc3,rad={BEND}", patchA=start, patchB=end, shrinkA=0, shrinkB=2,
        arrowstyle="-|>", mutation_scale=14.0, color=GREY, zorder=1,
    ))  # fmt: skip
    along = last - first
    _write(axes, first + 0.5 * along + 0.5 * BEND * np.array([along[1], -along[0]]), text, "normal")


def _write(axes: Axes, place: Floats, text: str, weight: str) -> None:
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.0 if weight == "bold" else 0.8}
    axes.text(
        place[0], place[1], text, ha="center", va="center", fontsize=8, color=DARK, zorder=4, weight=weight, bbox=box,
        parse_math=False,
    )  # fmt: skip

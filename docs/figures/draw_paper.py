"""Draws figures 2 and 6 of the paper anew: `python -m docs.figures.draw_paper [DIR]` (default docs/pictures).

The paper's own pictures are not at hand: these are made from its text and from this code. Fig. 6 is what
`clean-swarm look draw cleaning` draws.
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from docs.figures.blocks import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    YELLOW,
    Block,
    canvas,
    draw_arrow,
    draw_block,
    draw_frame,
)
from selector.configurations.library import Library
from selector.coordination.model import coordinator_models
from selector.coordination.robot_document import coordinated_goals
from selector.documents.find import find_file
from selector.knowledge import load_knowledge
from train.reports.network_content import robot_panels
from train.reports.network_picture import draw_panels

PATH, KNOWLEDGE = find_file("robots", "cleaning"), load_knowledge("cleaning")
COORDINATORS = {m.goal: m for m in coordinator_models(coordinated_goals(PATH), KNOWLEDGE, Library())}


def draw_architecture() -> Figure:
    """Return Fig. 2: how gradients, mechanisms and the behaviour network make a robot."""
    figure, axes = canvas(11.6, 5.3, "Architecture of a robot")
    around = ("other robots,", "items, stations,", "pheromones")
    world = draw_block(axes, Block(0.2, 0.25, 1.5, 4.6, "Environment", around, GREY))
    draw_frame(axes, Block(2.0, 0.25, 9.4, 4.6, "Robot"))
    stored = ("stores, aggregates,", "evaporates gradients", "selforg/gradients")
    buffer = draw_block(axes, Block(3.0, 3.05, 1.75, 1.3, "SoBuffer", stored, YELLOW))
    own = draw_block(axes, Block(3.0, 1.75, 1.75, 0.8, "Own sensing", ("garbage, stations,", "cargo, pose"), YELLOW))
    asked = ("movement: a vector", "decision: value, state", "selforg/mechanisms")
    mechanisms = draw_block(axes, Block(5.3, 3.05, 1.75, 1.3, "Mechanisms", asked, PINK))
    draw_frame(axes, Block(7.75, 0.4, 3.5, 4.2, "Behaviour network", ("selforg/network",)))
    sensors = draw_block(axes, Block(7.95, 3.2, 1.4, 0.65, "Sensors", ("readings",), GREY))
    conditions = draw_block(axes, Block(7.95, 2.05, 1.4, 0.65, "Conditions", ("satisfaction, wish",), YELLOW), 7.5)
    does = ("preconditions,", "effects, activation")
    behaviours = draw_block(axes, Block(7.95, 0.6, 1.4, 0.8, "Behaviours", does, BLUE), 7.5)
    goals = draw_block(axes, Block(9.95, 2.05, 1.15, 0.65, "Goals", (), GREEN))
    planner = draw_block(axes, Block(9.95, 0.675, 1.15, 0.65, "Planner", (), ORANGE))
    act = draw_block(axes, Block(3.0, 0.6, 1.75, 0.8, "Actions", ("drive, spread,", "pick, recycle, dump"), BLUE))
    draw_arrow(axes, world.at("right", 0.75), buffer.at("left"), "gradients", shift=(0.14, 0.14))
    draw_arrow(axes, world.at("right", 0.413), own.at("left"), "readings", shift=(0.14, 0.14))
    draw_arrow(axes, buffer.at("right"), mechanisms.at("left"), "in view", shift=(0.0, 0.14))
    draw_arrow(axes, mechanisms.at("right"), sensors.at("left", 0.77), "vector,\nvalue,\nstate")
    draw_arrow(axes, own.at("right"), sensors.at("left", 0.1))
    draw_arrow(axes, sensors.at("bottom"), conditions.at("top"))
    draw_arrow(axes, conditions.at("bottom"), behaviours.at("top"))
    draw_arrow(axes, conditions.at("right"), goals.at("left"))
    draw_arrow(axes, goals.at("bottom", 0.2), behaviours.at("right", 0.85), "wishes")
    draw_arrow(axes, planner.at("left"), behaviours.at("right", 0.5), "plan", shift=(0.0, -0.14))
    draw_arrow(axes, behaviours.at("left"), act.at("right"), "behaviours that run", shift=(0.0, 0.14))
    draw_arrow(axes, act.at("left"), world.at("right", 0.163), "commands,\nspread\ngradients", shift=(0.14, 0.32))
    return figure


def draw_network() -> Figure:
    """Return Fig. 6: the behaviour network of the cleaning robot."""
    return draw_panels(robot_panels(PATH, COORDINATORS, KNOWLEDGE))


def main() -> None:
    """Draw and save all figures."""
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "pictures"
    figures = {
        "paper_2_architecture": draw_architecture,
        "paper_6_network": draw_network,
    }
    for name, draw in figures.items():
        draw().savefig(directory / f"{name}.png", dpi=110)


if __name__ == "__main__":
    main()

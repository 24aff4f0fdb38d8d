"""Draws the figures of the paper anew: `python -m docs.figures.draw_paper [DIR]` (default docs/pictures).

The paper's own pictures are not at hand: these are made from its text and from this code.
Fig. 1 comes from the table of patterns, Fig. 5 is a mission, Fig. 6 is what `clean-swarm look draw cleaning` draws;
names in the others come from documents and registries.
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
from docs.figures.draw_patterns import draw_patterns
from docs.figures.draw_trajectories import draw_trajectories
from selector.configurations.library import Library
from selector.coordination.model import coordinator_models
from selector.coordination.robot_document import coordinated_goals, load_network
from selector.documents.find import find_file
from selector.knowledge import load_knowledge
from selector.strategies.registry import STRATEGIES
from train.reports.network_content import robot_panels
from train.reports.network_picture import draw_panels

DIRECTORY = Path(__file__).parents[1] / "pictures"
ROBOT = "cleaning"
"""The robot of the paper's experiment, in `configs/robots` and `configs/knowledge`."""
PATH, KNOWLEDGE = find_file("robots", ROBOT), load_knowledge(ROBOT)
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


def draw_coordination() -> Figure:
    """Return Fig. 3: the coordination mechanism selector inside the behaviour network of the cleaning robot."""
    model = load_network(PATH, COORDINATORS).model
    ((goal, coordinator),) = COORDINATORS.items()
    plain = [behaviour.name for behaviour in model.behaviours if not behaviour.alternatives]
    figure, axes = canvas(11.6, 5.4, "The coordination mechanism selector in the network")
    draw_frame(axes, Block(0.2, 0.25, 8.0, 4.7, f"Behaviour network of the {ROBOT} robot"))
    others = draw_block(axes, Block(0.5, 1.0, 1.75, 2.1, "Behaviours", plain, BLUE))
    goals = draw_block(axes, Block(0.5, 3.5, 1.75, 0.95, "Goals", [g.name for g in model.goals], GREEN))
    draw_arrow(axes, goals.at("bottom"), others.at("top"), "wishes")
    holder = draw_frame(
        axes, Block(3.6, 0.5, 4.4, 3.95, f"Coordinator {goal}", ("a behaviour with a network of its own",), ORANGE)
    )
    draw_arrow(axes, goals.at("right"), holder.at("left", 0.88), "wishes")
    draw_arrow(axes, holder.at("left", 0.392), others.at("right"), "preconditions and\neffects of what\nit holds now")
    draw_frame(axes, Block(3.8, 0.7, 4.0, 2.85, "Configuration of the option held", (), "white"))
    mechanism = draw_block(axes, Block(4.0, 2.15, 1.6, 0.8, "Mechanism", ("e.g. RepulsionGradient",), PINK), 7.5)
    sensors = draw_block(axes, Block(6.1, 2.15, 1.5, 0.8, "Sensors", [s.name for s in coordinator.sensors], GREY))
    names = sorted({b.name for c in coordinator.configurations for b in c.network_behaviours()})
    inside = draw_block(axes, Block(5.0, 0.9, 1.6, 0.7, "Behaviour", names, BLUE))
    draw_arrow(axes, mechanism.at("right"), sensors.at("left"))
    draw_arrow(axes, sensors.at("bottom"), inside.at("right", 0.6), bend=-0.25)
    draw_arrow(axes, mechanism.at("bottom"), inside.at("left", 0.6), "moves by", bend=0.25, shift=(-0.2, -0.1))
    chooser = draw_block(axes, Block(9.2, 2.75, 2.15, 0.95, "Decision strategy", ("which option now?",), ORANGE))
    options = draw_block(
        axes,
        Block(9.2, 0.85, 2.15, 1.15, f"Options of {goal}", [o.name for o in KNOWLEDGE.options(goal)], YELLOW),
        7.5,
    )
    draw_arrow(axes, options.at("top"), chooser.at("bottom"), "scores")
    draw_arrow(axes, chooser.at("left"), holder.at("right", 0.689), "swaps the\ncontent")
    return figure


def draw_selector() -> Figure:
    """Return Fig. 4: the parts of the selector and what they hand on."""
    library, strategies = Library(), STRATEGIES.names()
    known = load_knowledge("library")
    figure, axes = canvas(11.6, 4.9, "Parts of the selector")
    goal = draw_block(
        axes,
        Block(
            0.25,
            2.75,
            1.75,
            1.2,
            "Goal",
            ("of self-organisation,", f"{len(known.goals)} in the library", "e.g. FormationControl"),
            GREEN,
        ),
    )
    expert = draw_block(
        axes,
        Block(
            2.75,
            2.75,
            2.2,
            1.2,
            "Expert knowledge",
            ("goal: options, each with", "configuration, score,", "parameters"),
            YELLOW,
        ),
    )
    strategy = draw_block(
        axes,
        Block(
            5.9,
            2.75,
            2.3,
            1.2,
            "Decision strategy",
            ("MaxScore as in the paper,", f"{len(strategies) - 1} others: bandits,", "learned policies, ..."),
            ORANGE,
        ),
    )
    files = draw_block(
        axes,
        Block(
            9.15,
            2.75,
            2.2,
            1.2,
            "Configuration library",
            (f"{len(library.keys)} configurations:", "mechanisms, sensors,", "behaviours, goals"),
            PINK,
        ),
    )
    held = draw_block(
        axes,
        Block(
            9.15, 0.5, 2.2, 1.1, "Coordinator", ("runs the configuration", "with the option's", "parameters"), ORANGE
        ),
    )
    store = draw_block(
        axes,
        Block(5.9, 0.5, 2.3, 1.1, "Knowledge store", ("what options gave,", "by context and source", "(ours)"), GREY),
    )
    draw_arrow(axes, goal.at("right"), expert.at("left"))
    draw_arrow(axes, expert.at("right"), strategy.at("left"), "options", shift=(0.0, 0.15))
    draw_arrow(axes, strategy.at("right"), files.at("left"), "key,\nparameters", shift=(0.0, 0.25))
    draw_arrow(axes, files.at("bottom"), held.at("top"), "components")
    draw_arrow(axes, held.at("left"), store.at("right"), "rewards", shift=(0.0, 0.15))
    draw_arrow(axes, store.at("top"), strategy.at("bottom"), "learned scores (ours)")
    return figure


def draw_network() -> Figure:
    """Return Fig. 6: the behaviour network of the cleaning robot."""
    return draw_panels(robot_panels(PATH, COORDINATORS, KNOWLEDGE))


def main() -> None:
    """Draw and save all figures."""
    directory = Path(sys.argv[1]) if len(sys.argv) > 1 else DIRECTORY
    figures = {
        "paper_1_patterns": draw_patterns,
        "paper_2_architecture": draw_architecture,
        "paper_3_coordination": draw_coordination,
        "paper_4_selector": draw_selector,
        "paper_5_mission": draw_trajectories,
        "paper_6_network": draw_network,
    }
    for name, draw in figures.items():
        draw().savefig(directory / f"{name}.png", dpi=110)
        print(directory / f"{name}.png")


if __name__ == "__main__":
    main()

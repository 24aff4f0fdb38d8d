"""Diagrams say everything a network holds, in words, and no text covers another."""

import itertools

import pytest

from selector.configurations.library import Library
from selector.coordination.model import coordinator_models
from selector.coordination.robot_document import coordinated_goals
from selector.documents.find import find_file
from selector.knowledge import Knowledge, load_knowledge
from selforg.network.model.activators import Boolean, Equal, Greedy, Linear, Threshold
from selforg.network.model.conditions import Condition, Conjunction, Disjunction, Negation, Optional
from train.reports.network_content import (
    condition_in_words,
    configuration_panels,
    robot_panels,
)
from train.reports.network_picture import BORDER, HEADING, draw_panels, place_boxes, text_width

NESTED = """
root: robot
networks:
  robot:
    sensors: {far: number, seen: fact}
    conditions:
      near: {sensor: far, activator: {type: Linear, zero: 5.0, full: 1.0}}
    behaviours:
      Approach: {preconditions: [near], effects: [{sensor: far, change: -1.0}], network: approach}
      Leave: {effects: [{sensor: far, change: 0.5}]}
    goals:
      Reach: {conditions: [near], permanent: false}
  approach:
    sensors: {far: number}
    behaviours:
      Straight: {preconditions: [near]}
"""


def _robot(name: str):
    path, known = find_file("robots", name), load_knowledge(name)
    models = coordinator_models(coordinated_goals(path), known, Library())
    return robot_panels(path, {model.goal: model for model in models}, known)


@pytest.fixture(scope="module")
def cleaning():
    (panel,) = _robot("cleaning")
    return panel


@pytest.fixture
def nested(tmp_path):
    (tmp_path / "nested.yaml").write_text(NESTED)
    return robot_panels(tmp_path / "nested.yaml", {}, Knowledge({}))


def _boxes(panel, kind):
    return {box.lines[0]: box.lines[1:] for box in panel.boxes.values() if box.kind == kind}


def _links(panel, kind):
    return {link for link, own in panel.links.items() if own == kind}


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        (Condition("carrying", Boolean()), "carrying"),
        (Condition("carrying", Boolean(False)), "not carrying"),
        (Negation(Condition("carrying", Boolean())), "not carrying"),
        (Condition("far", Threshold(2.0)), "far ≥ 2"),
        (Condition("far", Threshold(2.0, minimum=False)), "far ≤ 2"),
        (Condition("far", Linear(0.0, 1.5)), "far: none at 0, full at 1.5"),
        (Condition("far", Greedy(maximise=False)), "far ever less"),
        (Condition("state", Equal(3.0)), "state = 3"),
        (Condition("at", Boolean(low=0.25)), "at (0.25 to 1)"),
        (Optional(Condition("far", Equal(0.0))), "optional: far = 0"),
        (Negation(Condition("far", Threshold(2.0))), "not (far ≥ 2)"),
        (
            Disjunction(
                Condition("a", Boolean()), Conjunction(Condition("b", Boolean()), Condition("c", Boolean(False)))
            ),
            "a or (b and not c)",
        ),
    ],
)
def test_conditions_are_said_in_words(condition, words):
    assert condition_in_words(condition) == words


def test_the_cleaning_robot_shows_all_that_its_document_declares(cleaning):
    assert len(_boxes(cleaning, "sensors")) == 12
    assert list(_boxes(cleaning, "behaviours")) == [
        "Patrol", "MoveToGarbage", "PickGarbage", "MoveToRecycling", "Recycle", "MoveToDump", "Dump",
    ]  # fmt: skip
    assert set(_boxes(cleaning, "goals")) == {"PatrolEnvironment", "GarbageCleaned", "AvoidCollision"}
    assert ("sensor.carrying", "condition.not carrying") in _links(cleaning, "is read by")
    assert ("condition.not carrying", "behaviour.PickGarbage") in _links(cleaning, "is needed by")
    assert ("behaviour.PickGarbage", "effect.carrying +1") in _links(cleaning, "effect: raises")
    assert ("behaviour.Dump", "effect.carrying \N{MINUS SIGN}1") in _links(cleaning, "effect: lowers")
    assert ("effect.garbage_found \N{MINUS SIGN}1", "goal.GarbageCleaned") in _links(cleaning, "helps the goal")


def test_a_coordinator_shows_its_options_and_what_comes_with_them(cleaning):
    assert _boxes(cleaning, "coordinators") == {
        "AvoidCollision": (
            "RepulsionFernandez-view2.0, score 1: view_distance 2.0",
            "RepulsionFernandez-view1.5, score 0: view_distance 1.5",
            "RepulsionGradient-view1.5, score 0.5: view_distance 1.5",
        )
    }
    sensors = _boxes(cleaning, "sensors")
    assert sensors["rep_bool (fact)"] == ("comes with AvoidCollision",)
    assert sensors["carrying (fact)"] == ()
    assert len(_links(cleaning, "optional: adds its wish only")) == 1


def test_inner_networks_are_panels_of_their_own(nested):
    assert [panel.title for panel in nested] == ["robot nested", "network inside Approach"]
    assert _boxes(nested[0], "behaviours")["Approach"] == ("holds a network, below",)
    assert list(_boxes(nested[1], "behaviours")) == ["Straight"]


def test_what_hinders_a_goal_is_told_from_what_helps_it(nested):
    assert _links(nested[0], "helps the goal") == {("effect.far \N{MINUS SIGN}1", "goal.Reach")}
    assert _links(nested[0], "hinders the goal") == {("effect.far +0.5", "goal.Reach")}
    assert _boxes(nested[0], "goals")["Reach"][-1] == "until it is reached"


@pytest.mark.parametrize("name", Library().keys)
def test_every_shipped_configuration_can_be_drawn_without_overlap(name):
    (panel,) = configuration_panels(find_file("mechanisms", name))
    _assert_readable(panel)


@pytest.mark.parametrize("name", ["cleaning", "cleaning-patrol"])
def test_every_shipped_robot_can_be_drawn_without_overlap(name):
    for panel in _robot(name):
        _assert_readable(panel)


def test_names_are_drawn_as_they_are_written(tmp_path):
    odd = NESTED.replace("Straight", "Straight_on").replace("Leave", "Leave x_2 and - y").replace("far", "a" * 90)
    (tmp_path / "odd.yaml").write_text(odd)
    panels = robot_panels(tmp_path / "odd.yaml", {}, Knowledge({}))
    for panel in panels:
        _assert_readable(panel)
    drawn = [text.get_text() for text in draw_panels(panels).axes[0].texts if not text.get_parse_math()]
    assert "Leave x_2 and - y" in drawn


def _assert_readable(panel):
    """All links end in boxes, boxes lie apart and inside, and each text fits its box."""
    boxes = place_boxes(panel)
    for start, end in panel.links:
        assert boxes[start].x + boxes[start].width < boxes[end].x
    for a, b in itertools.combinations(boxes.values(), 2):
        apart_across = a.x + a.width <= b.x or b.x + b.width <= a.x
        apart_along = a.y + a.height <= b.y or b.y + b.height <= a.y
        assert apart_across or apart_along, (a.box.key, b.box.key)
    for box in boxes.values():
        assert box.x >= BORDER
        assert box.y >= HEADING
        assert all(text_width(line, i < box.bold) < box.width for i, line in enumerate(box.lines))


def test_drawn_text_lies_inside_the_figure_and_apart(cleaning):
    figure = draw_panels([cleaning])
    figure.canvas.draw()
    (axes,) = figure.axes
    frames = [text.get_window_extent() for text in axes.texts]
    width, height = figure.canvas.get_width_height()
    assert all(f.x0 >= 0 and f.y0 >= 0 and f.x1 <= width and f.y1 <= height for f in frames)
    assert not [(a, b) for a, b in itertools.combinations(frames, 2) if a.padded(-1.0).overlaps(b.padded(-1.0))]

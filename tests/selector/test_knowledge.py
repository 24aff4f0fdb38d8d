import re

import pytest

from selector.configurations.library import Library
from selector.documents.errors import DocumentError
from selector.knowledge import Option, knowledge_from, learned_from, load_knowledge
from tests.selector.refusing import refusal

OPTIONS = [
    {"configuration": "A", "score": 1},
    {"configuration": "A", "name": "A-far", "score": 0.5, "parameters": {"view_distance": 9.0}},
    {"configuration": "B", "score": -2.0},
]


def test_options_keep_their_order_and_are_named_by_their_configuration():
    knowledge = knowledge_from({"goals": {"Avoid": OPTIONS}})
    assert knowledge.goals == ("Avoid",)
    assert [option.name for option in knowledge.options("Avoid")] == ["A", "A-far", "B"]
    assert knowledge.options("Avoid")[1].parameters == {"view_distance": 9.0}
    assert knowledge.scores("Avoid").tolist() == [1.0, 0.5, -2.0]


def test_scores_are_laid_over_and_the_rest_stays():
    knowledge = knowledge_from({"goals": {"Avoid": OPTIONS, "Reach": OPTIONS[:1]}})
    forced = knowledge.with_scores({"Avoid": {"B": 3, "A": 0.0}})
    assert forced.scores("Avoid").tolist() == [0.0, 0.5, 3.0]
    assert forced.options("Avoid")[1] == knowledge.options("Avoid")[1]
    assert forced.scores("Reach").tolist() == [1.0]
    assert knowledge.scores("Avoid").tolist() == [1.0, 0.5, -2.0]


@pytest.mark.parametrize(
    ("scores", "message"),
    [
        ({"Avoid": {"C": 1.0}}, r"k\.yaml: goals\.Avoid: unknown option 'C' \(known: A, A-far, B"),
        ({"Avid": {"A": 1.0}}, r"k\.yaml: unknown goal 'Avid' \(known: Avoid; did you mean 'Avoid'\?\)"),
        ({"Avoid": {"A": float("nan")}}, r"goals\.Avoid\.A: expected a finite score, got nan"),
    ],
)
def test_scores_for_what_does_not_exist_are_refused(scores, message):
    with pytest.raises(DocumentError, match=message):
        knowledge_from({"goals": {"Avoid": OPTIONS}}, "k.yaml").with_scores(scores)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"goal": {}}, "k.yaml: goal: unknown key"),
        ({"goals": {"G": []}}, r"goals\.G: .*at least 1 item.*got \[\]"),
        ({"goals": {"G": [["A", 1.0, {}]]}}, r"goals\.G\.0: expected a valid dictionary"),
        ({"goals": {"G": [{"configuration": "A"}]}}, r"goals\.G\.0\.score: missing key"),
        ({"goals": {"G": [{"configuration": "A", "score": "1"}]}}, r"goals\.G\.0\.score: expected .*number, got '1'"),
        ({"goals": {"G": [{"configuration": "A", "score": True}]}}, r"goals\.G\.0\.score: expected .*number, got True"),
        ({"goals": {"G": [{"configuration": "A", "score": 1.0, "scroe": 2.0}]}}, r"goals\.G\.0\.scroe: unknown key"),
        ({"goals": {"G": [OPTIONS[0], OPTIONS[0]]}}, r"k\.yaml: goals\.G: option 'A' is given twice"),
        ({}, "goals: missing key"),
    ],
)
def test_mistakes_name_file_and_key_in_one_line(content, message):
    assert re.search(message, refusal(knowledge_from, content, "k.yaml"))


def test_cleaning_knowledge_holds_the_papers_options():
    knowledge = load_knowledge("cleaning")
    Library().check(knowledge)
    assert knowledge.options("AvoidCollision") == (
        Option(configuration="RepulsionFernandez", score=1.0, parameters={"view_distance": 2.0}),
        Option(
            configuration="RepulsionFernandez",
            name="RepulsionFernandez-view1.5",
            score=0.0,
            parameters={"view_distance": 1.5},
        ),
        Option(configuration="RepulsionGradient", score=0.5, parameters={"view_distance": 1.5}),
    )


def test_knowledge_that_the_library_cannot_build_names_goal_and_option():
    option = {"configuration": "RepulsionGradient", "name": "near", "score": 1.0, "parameters": {"view": 1.0}}
    with pytest.raises(DocumentError, match=r"k\.yaml: goals\.G\.near: .*RepulsionGradient\.yaml: .*parameter 'view'"):
        Library().check(knowledge_from({"goals": {"G": [option]}}, "k.yaml"))


@pytest.mark.parametrize("content", [[1], {"Avoid": [1]}, "Avoid"])
def test_what_was_learned_is_a_mapping_of_options_by_goal(content):
    with pytest.raises(DocumentError, match=r"^learned: expected a mapping of options by goal, got "):
        learned_from(content, "learned")

import re

import pytest

from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.documents.errors import DocumentError
from selector.documents.find import files_of
from selector.knowledge import Option, knowledge_from, learned_from, library_options, load_knowledge, must_know_option
from tests.selector.refusing import refusal

GOAL = "AvoidCollision"
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
        ({"goals": {"G": [OPTIONS[0], OPTIONS[0]]}}, r"k\.yaml: goals\.G: expected unique names, got 'A' twice"),
        ({}, "goals: missing key"),
        ({"goals": {"G": [{"score": 1.0}]}}, r"goals\.G: name: expected at least 1 character"),
        (
            {"goals": {GOAL: [{"name": "ORCA", "score": 1.0, "parameters": {"x": 1}}]}},
            r"expected ORCA {}, .*got {'x': 1}",
        ),
        ({"goals": {GOAL: [{"name": "ORCAS", "score": 1.0}]}}, r"unknown option 'ORCAS' .*'ORCA'\?\); one of your own"),
        (
            {"goals": {GOAL: [{"configuration": "ORCA", "score": 1.0, "parameters": {"distance": 0.7}}]}},
            r"option 'ORCA': expected ORCA {}, as in the library, got .*0.7}; take that by {name: ORCA}, or",
        ),
    ],
)
def test_mistakes_name_file_and_key_in_one_line(content, message):
    assert re.search(message, refusal(knowledge_from, content, "k.yaml"))


def test_cleaning_knowledge_holds_the_papers_options():
    knowledge = load_knowledge("cleaning")
    CoordinatorModel("AvoidCollision", knowledge, Library())
    assert knowledge.options("AvoidCollision") == (
        Option(
            configuration="RepulsionFernandez",
            name="RepulsionFernandez-view2.0",
            score=1.0,
            parameters={"view_distance": 2.0},
        ),
        Option(
            configuration="RepulsionFernandez",
            name="RepulsionFernandez-view1.5",
            score=0.0,
            parameters={"view_distance": 1.5},
        ),
        Option(
            configuration="RepulsionGradient",
            name="RepulsionGradient-view1.5",
            score=0.5,
            parameters={"view_distance": 1.5},
        ),
    )


def test_knowledge_that_the_library_cannot_build_names_goal_and_option():
    option = {"configuration": "RepulsionGradient", "name": "near", "score": 1.0, "parameters": {"view": 1.0}}
    with pytest.raises(DocumentError, match=r"k\.yaml: goals\.G\.near: .*RepulsionGradient\.yaml: .*parameter 'view'"):
        CoordinatorModel("G", knowledge_from({"goals": {"G": [option]}}, "k.yaml"), Library())


@pytest.mark.parametrize(
    ("goal", "name", "where"),
    [
        (GOAL, "ORCA", "avoidance, exploring, transport"),
        (GOAL, "Patrol", ""),
        (f"ExplorationPatrol+{GOAL}", "Finds+ORCA", "exploring"),
    ],
)
def test_an_unknown_option_says_which_knowledge_has_it(goal, name, where):
    found = f"; it is in the knowledge {where} (--knowledge)" if where else ""
    with pytest.raises(DocumentError) as told:
        must_know_option(goal, name, ("Off",), "k.yaml")
    assert str(told.value) == f"k.yaml: unknown option '{name}' (known: Off){found}"
    must_know_option(goal, "Off", ("Off",), "k.yaml")


@pytest.mark.parametrize("content", [[1], {"Avoid": [1]}, "Avoid"])
def test_what_was_learned_is_a_mapping_of_options_by_goal(content):
    with pytest.raises(DocumentError, match=r"^learned: expected a mapping of options by goal, got "):
        learned_from(content, "learned")


def test_a_name_of_the_library_stands_for_one_configuration_with_one_set_of_numbers():
    known, unused = dict[str, Option](), set()
    for goal in files_of("options"):
        options = library_options(goal)
        assert all(option.same(known.setdefault(option.name, option)) for option in options)
        assert not any(one.same(other) for one in options for other in options if one is not other)
        unused |= {(goal, option.name) for option in options}
    for name in files_of("knowledge"):
        shipped = load_knowledge(name)
        unused -= {(goal, option.name) for goal in shipped.goals for option in shipped.options(goal)}
    assert unused == set()
    assert [len(library_options(goal)) for goal in (GOAL, "ExplorationPatrol")] == [11, 8]
    assert library_options("Nothing") == ()


def test_files_of_options_add_up_and_a_name_has_the_same_numbers_in_all(tmp_path, monkeypatch):
    for folder, view in (("plugin", 7.0), ("mine", 8.0)):
        (tmp_path / folder / "options").mkdir(parents=True)
        (tmp_path / folder / "options" / f"{GOAL}.yaml").write_text(
            f"{folder}: {{configuration: ORCA, parameters: {{view_distance: {view}}}}}\nORCA: {{configuration: ORCA}}\n"
        )
    monkeypatch.setattr("selector.documents.find.folders", lambda: {tmp_path / "plugin": "a plug-in"})
    shipped = library_options(GOAL)
    content = {"goals": {GOAL: [{"name": name, "score": 1.0} for name in ("mine", "plugin", "ORCA")]}}
    options = knowledge_from(content, "k.yaml", [tmp_path / "mine"]).options(GOAL)
    assert [(option.parameters, option.score) for option in options] == [
        ({"view_distance": 8.0}, 1.0), ({"view_distance": 7.0}, 1.0), ({}, 1.0)
    ]  # fmt: skip
    assert library_options(GOAL, [tmp_path / "mine"]) == (*shipped, options[0].model_copy(update={"score": 0.0}))
    (tmp_path / "mine" / "options" / f"{GOAL}.yaml").write_text("plugin: {configuration: ORCA}")
    message = (
        rf"mine/options/{GOAL}.yaml: {GOAL}: option 'plugin': expected ORCA {{'view_distance': 7.0}}, got ORCA {{}}"
    )
    assert re.search(message, refusal(library_options, GOAL, [tmp_path / "mine"]))

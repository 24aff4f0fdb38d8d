"""The report on a family: unfinished missions beside every mean, what is compared, and the figure."""

from types import SimpleNamespace

import pytest

from clean_swarm_env.config.families import FamilyConfig, scenario_name
from clean_swarm_env.config.load import load_family, load_mission
from clean_swarm_env.tasks.cleaning.cost import mission_cost
from tests.train.records import record
from train.advising.report import Advice
from train.analysis.family_report import FamilyReport, ratio_of
from train.analysis.runs import Runs
from train.reports.charts import picture_of
from train.reports.family_tables import family_tables
from train.reports.figures import draw_family

LIMIT, SCENARIOS = 20.0, 8


def report(left, conditions=("fixed:a", "fixed:b", "Random")):
    """Return the report of missions of 3 items that last 10 s; `left`: condition -> items left in the last one."""
    mission = load_mission("table1").model_copy(update={"time_limit": LIMIT})
    family = FamilyConfig(name="small", description="Three items.", mission=mission, items=(3, 3))
    scenario = family.scenario(0, 0, "test").mission
    records = []
    for c, condition in enumerate(conditions):
        for k in range(SCENARIOS):
            kept = left.get(condition, 0) if k == SCENARIOS - 1 else 0
            time = LIMIT if kept else 10.0 + c + 0.1 * k
            cost = mission_cost(scenario, time, 0, 0, 3 - kept)
            done = {"completed": not kept, "garbage_done": 3 - kept, "cost_s": cost}
            events = {f"collision_{kind}_per_s": (float(c),) * 2 for kind in ("events", "samples")}
            records.append(record(scenario_name("test", k), condition, time, **done, **events))
    named = {condition: (condition,) for condition in conditions}
    names = tuple((scenario_name("test", k),) for k in range(SCENARIOS))
    return FamilyReport.of(Runs(family, "AvoidCollision", 0, names, named, records))


def test_the_share_of_unfinished_missions_stands_beside_every_mean():
    found = report({"Random": 2})
    assert found.verdict[-1] == "1 of 24 missions was left unfinished, by Random."
    grid = family_tables(found)[0]
    place = grid.heads.index("unfinished (at most)")
    shares = {row[0]: row[place] for row in grid.rows}
    assert shares == {"fixed:a": "0% (31%)", "fixed:b": "0% (31%)", "Random": "12% (47%)"}


def test_a_single_fixed_option_is_not_called_the_best():
    _, gaps = family_tables(report({}, conditions=("fixed:a", "Random")))
    assert gaps.title == "cost beside fixed:a"
    assert "ratio to fixed:a" in gaps.heads
    assert "only fixed option that ran" in gaps.notes[0]


@pytest.mark.parametrize(("name", "tests"), [("ReachGoal", 1), ("table1", 2)])
def test_costs_of_tasks_with_measures_are_known_however_a_mission_ends(name, tests):
    own = [record("test-1", "a"), record("test-1", "b", completed=False)]
    runs = Runs(load_family(name), "", 0, (("test-1",),), {"a": ("a",), "b": ("b",)}, own)
    advice = Advice(None, None, SimpleNamespace(winner="b"), runs, {})
    assert len(advice.ratio("a").tests) == len(ratio_of(runs, "a", "b").tests) == tests


def test_the_figure_shows_costs_and_durations_side_by_side_and_nothing_below_0():
    figure = draw_family(report({"Random": 2}, conditions=("fixed:a", "fixed:b", "Random")))
    picture_of(figure, ".png")  # places the axes
    cost, duration = figure.axes
    assert [axes.get_xlabel() for axes in figure.axes] == ["cost [s]", "duration [s]"]
    assert [label.get_text() for label in cost.get_yticklabels()] == ["fixed:a", "fixed:b", "Random"]
    assert cost.get_ylim() == duration.get_ylim()
    assert min(cost.get_xlim()[0], duration.get_xlim()[0]) >= 0.0

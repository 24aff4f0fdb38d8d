"""The report on a family: unfinished missions beside every mean, ratios at other prices of them, and the figure."""

import itertools

from clean_swarm_env.config.families import FamilyConfig, scenario_name
from clean_swarm_env.config.load import load_mission
from clean_swarm_env.tasks.cleaning.cost import mission_cost
from tests.train.records import record
from train.analysis.family_report import FamilyRuns, family_report_of
from train.reports.charts import picture_of
from train.reports.family_tables import family_tables
from train.reports.figures import draw_family

LIMIT, SCENARIOS = 20.0, 8


def report(left, fixed=("fixed:a", "fixed:b"), conditions=("fixed:a", "fixed:b", "Random")):
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
            events = {"collision_events_per_s": (float(c),), "collision_samples_per_s": (float(c),)}
            records.append(record(scenario_name("test", k), condition, time, **done, **events))
    named = {condition: (condition,) for condition in conditions}
    return family_report_of(FamilyRuns(family, "AvoidCollision", 0, SCENARIOS, 1, named, fixed, records))


def test_the_share_of_unfinished_missions_stands_beside_every_mean():
    found = report({"Random": 2})
    assert found.verdict[-1] == "1 of 24 missions was left unfinished, by Random; up to 31% of a's may be."
    for grid in family_tables(found):
        (place,) = (k for k, head in enumerate(grid.heads) if head.startswith("unfinished"))
        shares = {row[0]: row[place] for row in grid.rows}
        bounds = (
            {"fixed:a": " (31%)", "fixed:b": " (31%)", "Random": " (47%)"} if "at most" in grid.heads[place] else {}
        )
        plain = {"fixed:a": "0%", "fixed:b": "0%", "Random": "12%"}
        assert shares == {label: share + bounds.get(label, "") for label, share in plain.items()}, grid.title


def test_a_single_fixed_option_is_not_called_the_best():
    _, gaps, _ = family_tables(report({}, fixed=("fixed:a",), conditions=("fixed:a", "Random")))
    assert gaps.title == "cost beside fixed:a"
    assert "ratio to fixed:a" in gaps.heads
    assert "only fixed option that ran" in gaps.notes[0]


def test_the_figure_shows_every_point_whole_and_nothing_below_0():
    figure = draw_family(report({}, conditions=("fixed:a", "fixed:b", "Random")))
    picture_of(figure, ".png")  # places the axes
    cost, duration, front, _ = figure.axes
    assert cost.get_xlim()[0] >= 0.0
    assert duration.get_xlim()[0] >= 0.0
    low, high = front.get_ylim()
    points = [bar.lines[0] for bar in front.containers]
    assert low < min(point.get_ydata()[0] for point in points) == 0.0
    assert low > -1.0
    assert all(tick >= 0.0 for tick in front.get_yticks())
    assert high > max(point.get_ydata()[0] for point in points)
    box = front.get_window_extent()
    for point in points:
        across, up = front.transData.transform((point.get_xdata()[0], point.get_ydata()[0]))
        assert box.x0 + 4 < across < box.x1 - 4
        assert box.y0 + 4 < up < box.y1 - 4


def test_no_two_strategies_look_alike():
    conditions = tuple(f"fixed:{letter}" for letter in "abcdefghijklmnopqrst")
    figure = draw_family(report({}, fixed=conditions, conditions=conditions))
    looks = {(line.get_color(), line.get_linestyle(), line.get_marker()) for line in figure.axes[3].get_lines()}
    assert len(looks) == len(conditions)
    neighbours = [line.get_marker() for line in figure.axes[3].get_lines()]
    assert all(one != other for one, other in itertools.pairwise(neighbours))  # also in print without colours

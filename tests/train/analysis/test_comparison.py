"""Strategies beside fixed options: ratios, the cross-fitted oracle, the gap, who takes part."""

import numpy as np
import pytest

from selector.documents.errors import DocumentError
from train.analysis.strategy_comparison import BestFixed, compare_strategies
from train.evaluation.conditions import conditions_of

OPTIONS = ("a", "b")


def excesses(worlds=1, **rows):
    """Return label -> (S, K, V), the same in all worlds."""
    tables = {name: np.atleast_2d(np.array(values, dtype=float)) for name, values in rows.items()}
    return {name: np.repeat(table[:, :, None], worlds, axis=2) for name, table in tables.items()}


def test_strategies_stand_beside_the_best_fixed_option_and_the_oracle():
    rows = {"one": [1, 4] * 10, "two": [3, 2, 3, 2.4] * 5, "learned": [1, 3, 2, 3] * 5}
    twice = {name: np.repeat(row, 2) for name, row in rows.items()}  # both halves are alike
    found = compare_strategies(excesses(2, **twice), ("one", "two"))
    assert (found.best_fixed.label, found.has_gap) == ("one", True)
    by_label = {standing.label: standing for standing in found.standings}
    assert found.gap.value == pytest.approx(2.5 - 1.6)
    assert by_label["oracle"].excess.value == pytest.approx((1 + 2 + 1 + 2.4) / 4)
    assert by_label["learned"].ratio.ratio == pytest.approx(2.25 / 2.5)


def test_luck_makes_no_gap():
    """Six runs of one option: the best of each scenario is luck, and other world seeds show it."""
    rng = np.random.default_rng(1)
    alike = {str(k): rng.gamma(4.0, 25.0, (1, 100, 4)) for k in range(6)}
    options = np.stack([table[0] for table in alike.values()])
    assert options.mean(axis=2).min(axis=0).mean() < 0.75 * options.mean()  # what was called an oracle
    found = compare_strategies(alike, tuple(alike))
    assert found.gap.ci95[0] < 0.0 or found.gap.value <= 0.0
    assert not found.has_gap
    assert found.standings[-1].ratio.ratio == pytest.approx(1.0, abs=0.1)


def test_an_option_that_is_best_in_all_worlds_of_a_scenario_makes_a_gap():
    rng = np.random.default_rng(2)
    better = rng.integers(2, size=(100, 1))
    rows = {str(k): (rng.gamma(4.0, 25.0, (100, 4)) * np.where(better == k, 0.6, 1.2))[None] for k in range(2)}
    found = compare_strategies(rows, tuple(rows))
    assert found.has_gap
    assert found.standings[-1].ratio.ratio == pytest.approx(0.7, abs=0.1)


def test_with_one_world_seed_there_is_no_oracle():
    found = compare_strategies(excesses(one=[1, 2, 3], learned=[1, 1, 1]), ("one",))
    assert found.gap is None
    assert [standing.label for standing in found.standings] == ["one", "learned"]
    assert found.standings[1].ratio.ratio == 0.5


def test_ratios_are_paired_and_several_training_seeds_widen_the_interval():
    rng = np.random.default_rng(0)
    fixed = rng.uniform(10.0, 1000.0, 40)
    same = np.tile(0.8 * fixed, (3, 1))
    spread = 0.8 * fixed * np.array([[0.8], [1.0], [1.2]])
    found = compare_strategies(excesses(fixed=fixed, same=same, spread=spread), ("fixed",))
    _, even, uneven = (standing.ratio for standing in found.standings)
    assert even.ci95 == pytest.approx((0.8, 0.8))  # whatever the scenario, it is 0.8
    assert uneven.ratio == pytest.approx(0.8)
    assert uneven.ci95[0] < 0.72 < 0.88 < uneven.ci95[1]
    assert found.standings[1].ratio.p < 0.001
    assert found.standings[0].ratio.p == 1.0


def test_an_option_of_seven_alike_ones_is_neither_better_nor_worse_than_the_best_fixed():
    """The lowest of seven noisy means is below what the same option costs on other scenarios."""
    rng, names = np.random.default_rng(3), [f"option {k}" for k in range(7)]
    ratios, lowest = [], []
    for _ in range(60):
        tables = {name: rng.gamma(1.0, 100.0, (1, 30, 1)) for name in [*names, "eighth"]}
        found = compare_strategies(tables, tuple(names))
        ratios.append(np.log(found.standings[-1].ratio.ratio))
        lowest.append(np.log(tables["eighth"].mean() / min(tables[name].mean() for name in names)))
    assert np.mean(lowest) > 0.2
    assert abs(np.mean(ratios)) < 0.1


def test_the_best_fixed_option_is_chosen_on_the_other_half_of_the_scenarios():
    rows = excesses(2, a=[1, 9, 2, 9], b=[5, 3, 6, 4], c=[7, 7, 7, 7])
    best = BestFixed.of(rows, ("a", "b", "c"))
    assert best.labels == ("b", "a")  # the odd scenarios like b, the even ones a
    assert best.label == "b / a"
    assert best.judged(rows)[0, :, 0].tolist() == [5, 9, 6, 9]
    alone = excesses(one=[3.0], two=[2.0])
    assert BestFixed.of(alone, ("one", "two")).label == "two"


def test_words_of_the_command_line_name_who_takes_part():
    found = conditions_of(["fixed", "rule", "mine=policy:x+y", "UCB1:prior=2", "LinUCB:f.safetensors"], OPTIONS)
    assert {label: one.members for label, one in found.items()} == {
        "fixed:a": ("fixed:a",),
        "fixed:b": ("fixed:b",),
        "rule": ("rule",),
        "mine": ("policy:x", "policy:y"),
        "UCB1:prior=2": ("UCB1:prior=2",),
        "LinUCB:f.safetensors": ("LinUCB:f.safetensors",),
    }
    assert found["mine"].names("mine") == ("mine#1", "mine#2")
    assert found["rule"].names("rule") == ("rule",)
    with pytest.raises(DocumentError, match="'fixed:a' is given twice"):
        conditions_of(["fixed", "fixed:a"], OPTIONS)

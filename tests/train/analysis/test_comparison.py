"""Strategies beside fixed options: ratios, the oracle, the share of the gap, and who takes part."""

import numpy as np
import pytest

from selector.documents.errors import DocumentError
from train.analysis.strategy_comparison import compare_strategies
from train.evaluation.entrants import Entrant, entrants_of

OPTIONS = ("a", "b")


def costs(**rows):
    return {name: np.atleast_2d(np.array(values, dtype=float)) for name, values in rows.items()}


def test_the_share_of_the_gap_is_0_for_the_best_fixed_option_and_1_for_the_oracle():
    found = compare_strategies(costs(one=[1, 4, 1, 4], two=[3, 2, 3, 2.4], learned=[1, 3, 2, 3]), ("one", "two"))
    assert found.best_fixed == "one"
    by_label = {standing.label: standing for standing in found.standings}
    assert [by_label[name].share.value for name in ("one", "oracle")] == [0.0, 1.0]
    assert by_label["oracle"].cost.value == pytest.approx((1 + 2 + 1 + 2.4) / 4)
    assert by_label["learned"].share.value == pytest.approx((2.5 - 2.25) / (2.5 - 1.6))
    assert by_label["learned"].ratio.value == pytest.approx(2.25 / 2.5)


def test_without_a_gap_there_is_no_share():
    found = compare_strategies(costs(one=[1, 2, 3], learned=[1, 1, 1]), ("one",))
    assert all(standing.share is None for standing in found.standings)
    assert found.standings[1].ratio.value == 0.5


def test_ratios_are_paired_and_several_training_seeds_widen_the_interval():
    rng = np.random.default_rng(0)
    fixed = rng.uniform(10.0, 1000.0, 40)
    same = np.tile(0.8 * fixed, (3, 1))
    spread = 0.8 * fixed * np.array([[0.8], [1.0], [1.2]])
    found = compare_strategies({"fixed": fixed[None], "same": same, "spread": spread}, ("fixed",))
    _, even, uneven, _ = (standing.ratio for standing in found.standings)
    assert even.ci95 == pytest.approx((0.8, 0.8))  # whatever the scenario, it is 0.8
    assert uneven.value == pytest.approx(0.8)
    assert uneven.ci95[0] < 0.72 < 0.88 < uneven.ci95[1]


def test_words_of_the_command_line_name_who_takes_part():
    found = entrants_of(["fixed", "rule", "mine=policy:x+y", "UCB1:prior=2", "LinUCB:f.safetensors"], OPTIONS)
    assert found == [
        Entrant("fixed:a", ("fixed:a",)),
        Entrant("fixed:b", ("fixed:b",)),
        Entrant("rule", ("rule",)),
        Entrant("mine", ("policy:x", "policy:y")),
        Entrant("UCB1:prior=2", ("UCB1:prior=2",)),
        Entrant("LinUCB:f.safetensors", ("LinUCB:f.safetensors",)),
    ]
    assert [entrant.fixed for entrant in found] == [True, True, False, False, False, False]
    with pytest.raises(DocumentError, match="'fixed:a' is given twice"):
        entrants_of(["fixed", "fixed:a"], OPTIONS)

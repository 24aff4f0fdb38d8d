"""Acceptance of learners, on invented missions whose truth is known and by naive formulas."""

import json
from dataclasses import asdict
from math import comb

import numpy as np
import pytest

from docs.comparison import acceptance, missions
from docs.comparison.acceptance import OVERALL, Acceptance, acceptance_tables, acceptances, figures_of
from docs.comparison.manifest import BEST, Manifest
from docs.comparison.missions import Judged
from docs.comparison.tables import FamilyFigures
from selector.documents.reading import as_yaml
from train.analysis.strategy_comparison import BestFixed

AT_MOST = {"b": 0.75}
SCENARIOS, SEEDS = 32, 3


def family(rng, ratio, *, lost=0, ends=True, seeds=SEEDS, spread=0.02):
    """Return missions in which a learner costs `ratio` of the best pair, and leaves the first `lost` unfinished."""
    best = rng.gamma(9.0, 10.0, SCENARIOS)
    own = ratio * best * rng.lognormal(0.0, 0.1, (seeds, SCENARIOS)) * rng.lognormal(0.0, spread, (seeds, 1))
    left = {BEST: np.zeros((1, SCENARIOS, 1)), "learner": np.zeros((seeds, SCENARIOS, 1))}
    left["learner"][:, :lost] = 1.0
    excesses = {BEST: best[None, :, None], "learner": own[:, :, None]}
    return FamilyFigures(BestFixed(("fixed:a", "fixed:a")), excesses, left if ends else {})


def judged(seed=1, ratios=(0.9, 0.95, 0.6, 0.9), at_most=AT_MOST, **changes):
    """Return the acceptance on the families a, b, c, d, of which `changes` changes some."""
    rng = np.random.default_rng(seed)
    names = dict(zip("acbd", ratios, strict=True))
    return Acceptance("learner", {k: family(rng, names[k], **changes.get(k, {})) for k in "acbd"}, at_most)


def test_who_saves_everywhere_is_accepted():
    found = judged(d={"ends": False})
    assert found.refusals == []
    assert found.verdict.startswith("`learner` costs 0.8")
    assert found.verdict.endswith(" of the best pairs of 4 families: accepted.")


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"ratios": (1.3, 0.8, 0.6, 0.8)}, "on `a` it costs 1.2"),
        ({"ratios": (1.03,) * 4, "at_most": {}, "a": {"spread": 0.2}}, "its geometric mean may be 1."),
        ({"a": {"lost": 3}, "d": {"lost": 4}}, "it leaves 7.0 missions more unfinished than the pairs (p 0.0078)"),
        ({"ratios": (0.9, 0.9, 0.8, 0.9)}, "on `b` it costs 0.8"),
    ],
)
def test_each_of_four_reasons_alone_refuses(changes, reason):
    (found,) = judged(**changes).refusals
    assert found.startswith(reason)
    assert judged(**changes).verdict.endswith(f" and is not accepted: {found}.")


def test_a_few_unfinished_missions_and_costs_that_may_be_chance_refuse_nobody():
    assert judged(a={"lost": 4}).refusals == []
    assert judged(ratios=(1.08, 0.8, 0.6, 0.8), a={"spread": 0.2}).refusals == []


def test_ratios_are_those_of_means_and_their_intervals_those_of_a_naive_bootstrap():
    found, rng = judged(), np.random.default_rng(7)
    logs, naive = [], []
    for one in found._figures.values():
        own, best = one.excesses["learner"][:, :, 0], one.excesses[BEST][0, :, 0]
        logs.append(np.log(sum(own.ravel()) / own.size / (sum(best) / best.size)))
    for _ in range(3000):
        seeds, drawn = rng.integers(0, SEEDS, SEEDS - 1), []
        for one in found._figures.values():
            own, best = one.excesses["learner"][:, :, 0], one.excesses[BEST][0, :, 0]
            scenarios = rng.integers(0, SCENARIOS, SCENARIOS - 1)
            drawn.append(np.log(own[np.ix_(seeds, scenarios)].mean() / best[scenarios].mean()))
        naive.append([*drawn, np.mean(drawn)])
    values = np.array([*found.ratios.values()])
    assert np.allclose(values[:, 0], np.exp([*logs, np.mean(logs)]))
    assert np.allclose(values[:, 1:].T, np.exp(np.quantile(naive, (0.025, 0.975), axis=0)), rtol=0.005)
    assert list(found.ratios) == [*"acbd", OVERALL]
    others = np.array([found.ratios[name][0] for name in "acb"])
    assert found.without_one["d"] == pytest.approx(others.prod() ** (1 / 3))
    lost = judged(a={"lost": 9})
    assert lost.unfinished == (9.0, pytest.approx(sum(comb(9, k) for k in (9,)) / 2**9))


def test_intervals_of_the_geometric_mean_hold_the_truth(monkeypatch):
    monkeypatch.setattr(acceptance, "RESAMPLES", 1000)
    held = 0
    for seed in range(60):
        found = judged(seed, ratios=(0.9,) * 4, **{name: {"seeds": 6} for name in "abcd"})
        _, low, high = found.ratios[OVERALL]
        held += low <= 0.9 * np.exp(0.5 * (0.1**2 + 0.02**2)) <= high
    assert held >= 51  # fewer than nine of ten hold what was meant if this fails


MANIFEST = {
    "name": "tried",
    "page": True,
    "goal": "AvoidCollision",
    "seed": 3,
    "strategies": {"recent-finds": "fsm:recent-finds", "told-bumpers": "fsm:told-bumpers"},
    "trained": {"ppo": {"training": "one", "seeds": (1,)}},
    "only": {"told-bumpers": ("random",)},
    "at_most": {"random": 0.75},
    "families": {name: {"scenarios": 20, "fixed": ("ORCA",)} for name in ("random", "table1-starts")},
}


def kept():
    """Return the missions of a manifest whose training saves three tenths, and the rules one tenth."""
    own, known = Manifest(**MANIFEST), np.arange(10.0, 30.0)
    shares = {"fixed:ORCA": 1.0, "ppo": 0.7, "recent-finds": 0.9, "told-bumpers": 0.9, "Random": 2.0}
    return own, {
        (name, label): Judged(name, label, label, 3, (shares[label] * known).tolist(), [], 0.0)
        for name in own.families
        for label in own.run_on(name)
    }


def test_tables_have_who_was_judged_on_all_families():
    manifest, found = kept()
    figures = figures_of(manifest, found)
    judged, tables = acceptances(manifest, figures), acceptance_tables(manifest, figures)
    assert {label: one.whole for label, one in judged.items()} == {
        "recent-finds": True, "told-bumpers": False, "ppo": True, "Random": True,
    }  # fmt: skip
    assert "`told-bumpers`" not in tables["accepted"]
    without = "{0} [{0}, {0}] | {0} (`random`) to {0} (`table1-starts`)".format
    assert f"| `ppo` | 1 | {without('0.700')} | 0 | +0.0, p 1 | 0.700 | yes |" in tables["accepted"]
    assert f"| `Random` | 1 | {without('2.000')} | 2 | +0.0, p 1 | 2.000 | no |" in tables["accepted"]
    assert "| best pair | ORCA | ORCA |" in tables["ratios"]
    assert "| `told-bumpers` | 0.900 [0.900, 0.900] | - |" in tables["ratios"]


def test_nothing_is_run_to_judge_and_each_learner_gets_a_sentence(tmp_path, capsys, monkeypatch):
    manifest, found = kept()
    given, written = tmp_path / "tried.yaml", {}
    given.write_bytes(as_yaml(manifest.model_dump(mode="json", exclude_none=True)).encode())
    given.with_suffix(".jsonl").write_text("\n".join(json.dumps(asdict(one)) for one in found.values()))
    monkeypatch.setattr(missions, "_judged", None)
    monkeypatch.setattr(acceptance, "ROOT", tmp_path)
    monkeypatch.setattr(acceptance, "inputs_of", lambda *_: [])
    monkeypatch.setattr(acceptance, "put_tables", lambda name, tables, *_: written.update({name: tables}))
    acceptance.main(["--judge", str(given)])
    assert capsys.readouterr().out == "- `ppo` costs 0.700 [0.700, 0.700] of the best pairs of 2 families: accepted.\n"
    assert list(written["tried"]) == ["accepted", "ratios"]

"""The command behind docs/choosing.md: what is there is kept, and tables say what the missions that are kept say."""

import json
from dataclasses import asdict

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.types import ConfigurationError
from docs.comparison import missions, write_choosing
from docs.comparison.manifest import BEST, OFF, TOLD, Manifest
from docs.comparison.missions import Judged, do_missions, family_of, read_missions
from docs.comparison.tables import Tables, share_of_way
from docs.figures.stored import parts
from selector.documents.find import load_file
from selector.documents.reading import as_yaml, read_mapping
from train.learning.config import TrainingConfig
from train.running.trial_task import TrialTask

SIZES = {"scenarios": 2, "fixed": ("ORCA", "PredictiveSteering"), "off": "Off"}
TOLD_OF = {"spots 0 stations 2": "ORCA"}
TRIED = {
    "name": "tried",
    "goal": "AvoidCollision",
    "seed": 3,
    "strategies": {"one": "policy:one", "rule": "MaxScore"},
    "only": {"rule": ("random",)},
    "families": {"random": {**SIZES, "told": TOLD_OF}, "table1-starts": {"scenarios": 2, "fixed": ("ORCA",)}},
}
OWN = Manifest(**read_mapping(write_choosing.OWN))
KEPT = write_choosing.OWN.with_suffix(".jsonl")


def test_missions_are_done_once_and_a_team_that_is_told_takes_what_serves_its_kind(tmp_path, monkeypatch):
    file, manifest = tmp_path / "missions.jsonl", Manifest(**TRIED)
    do_missions(manifest, file)
    whole, found = file.read_bytes(), read_missions(file, manifest)
    assert list(found) == [(family, label) for family in manifest.families for label in manifest.run_on(family)]
    assert ("table1-starts", "rule") not in found
    orca = found["random", "fixed:ORCA"]
    assert found["random", TOLD].excess_s == orca.excess_s
    given = load_family("random")
    alone = TrialTask("random", 3, (given.scenario(3, 1, "test"),), "", "fixed:ORCA", "AvoidCollision").run()
    assert orca.excess_s[1] == round(alone[0].result.excess_s, 4)
    assert orca.unfinished == []
    assert len(Tables(manifest, found).claims) == 5 + 1 + 2

    lines = whole.decode().splitlines()
    file.write_text("\n".join([*lines[:2], *lines[3:]]))
    do_missions(manifest, file)  # does one strategy again, with the same results
    assert [one.excess_s for one in read_missions(file, manifest).values()] == [one.excess_s for one in found.values()]
    monkeypatch.setattr(missions, "_judged", None)
    do_missions(manifest, file)
    with pytest.raises(ConfigurationError, match=r"fixed:ORCA on random: expected seed and scenarios .*\(4, 2\), got"):
        read_missions(file, manifest.model_copy(update={"seed": 4}))


def judged(**strategies):
    """Return the missions of one family; label -> excess."""
    return {
        ("random", label): Judged("random", label, label, 3, own.tolist(), [], 0.0) for label, own in strategies.items()
    }


def example(scenarios=20, **changes):
    """Return a manifest and missions of which `one` saves a fifth, half of the way of a told team."""
    known = np.arange(10.0, 10.0 + scenarios)
    own = {
        "one": 0.8 * known,
        "rule": known + np.sin(known),
        TOLD: 0.6 * known,
        "Random": 2.0 * known,
        OFF: 3.0 * known,
    }
    fixed = {"fixed:ORCA": known, "fixed:PredictiveSteering": 1.1 * known}
    families = {"random": {**SIZES, "scenarios": scenarios, "told": TOLD_OF}}
    return Manifest(**TRIED | {"families": families}), judged(**own | fixed | changes)


def test_tables_have_the_cheaper_fixed_option_ratios_and_bold_what_sign_flips_tell():
    tables = Tables(*example())
    shown = tables.tables()
    main = shown["main"].splitlines()[2]
    assert main.startswith("| `random` | 20 | ORCA | 19.5 | **0.800** [0.800, 0.800] | 0.998 [")
    assert tables.told("random", "one") == tables.told("random", "one", "rule") == -1.0
    assert tables.told("random", "rule") == 0.0
    assert main.endswith("**2.000** [2.000, 2.000] | **3.000** [3.000, 3.000] |")
    assert "| **0.600** [0.600, 0.600] | 50 % [50, 50] |" in shown["told"]
    assert tables.broken() == []
    few = Tables(*example(scenarios=6))
    assert {claim.holm for claim in few.claims.values()} == {None}
    assert "**" not in "".join(few.tables().values())


def test_unfinished_missions_have_a_test_of_their_own_and_heavy_tails_are_named():
    manifest, found = example()
    lost = found["random", "one"]
    excess = np.where(np.arange(20) < 12, 10_000.0, lost.excess_s)
    found["random", "one"] = Judged(**asdict(lost) | {"excess_s": excess.tolist(), "unfinished": list(range(12))})
    heavy = np.array(found["random", "rule"].excess_s)
    heavy[3] = 5_000.0
    found["random", "rule"] = Judged(**asdict(found["random", "rule"]) | {"excess_s": heavy.tolist()})
    tables = Tables(manifest, found)
    shown = tables.tables()
    assert tables.told("random", "one") == 1.0  # it is cheaper wherever both finish, but leaves twelve unfinished
    assert "| `random` | one / best | 8 of 20 | 0.800 [0.800, 0.800] |" in shown["both"]
    assert "rule / best" not in shown["both"]
    assert [cell.endswith("heavy ") for cell in shown["main"].splitlines()[2].split("|")[5:8]] == [False, True, True]


def test_what_has_to_be_better_and_is_not_shown_to_be_fails():
    manifest, found = example(one=np.arange(10.0, 30.0) + np.cos(np.arange(20.0)))
    (line,) = Tables(manifest.model_copy(update={"better": ("random",)}), found).broken()
    assert line.startswith("`random`: not shown to be better than the best options, 1.0")


def test_shares_of_the_way_have_intervals_that_hold_the_truth():
    rng, held = np.random.default_rng(4), 0
    for _ in range(60):
        told = rng.gamma(9.0, 10.0, 60)
        best, own = told + rng.normal(40.0, 20.0, 60), told + rng.normal(20.0, 20.0, 60)
        share, (low, high) = share_of_way(best, own, told, 500)
        assert low <= share <= high
        held += low <= 0.5 <= high
    assert 52 <= held < 60


@pytest.mark.parametrize("name", ["choosing", "learning", "protocol"])
def test_manifests_that_ship_name_what_there_is(name):
    manifest = Manifest(**read_mapping(write_choosing.OWN.with_name(f"{name}.yaml")))
    assert manifest.name == name
    for trained in manifest.trained.values():
        assert load_file("training", trained.training, TrainingConfig).validation.scenarios
    named = {family for families in (*manifest.only.values(), manifest.better) for family in families}
    assert named <= set(manifest.families)
    for family, compared in manifest.families.items():
        assert family_of(family, compared).name == family


def test_the_page_has_what_the_missions_that_are_kept_say():
    assert KEPT.stat().st_size < 300_000
    found = Tables(OWN, read_missions(KEPT, OWN)).tables()
    page = (write_choosing.ROOT / "docs" / "choosing.md").read_text(encoding="utf-8")
    assert {name: parts(page, name)[1] for name in found} == found


def test_nothing_is_run_to_judge_and_what_is_missing_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(missions, "_judged", None)
    monkeypatch.setattr(write_choosing, "ROOT", tmp_path)
    manifest, found = example()
    given, kept = tmp_path / "tried.yaml", tmp_path / "results" / "tried" / "missions.jsonl"
    given.write_bytes(as_yaml(manifest.model_dump(mode="json", exclude_none=True)).encode())
    kept.parent.mkdir(parents=True)
    lines = [json.dumps(asdict(one)) for one in found.values()]
    kept.write_text("\n".join(lines))
    assert write_choosing.main(["--judge", str(given)]) == 0
    assert f"random: one / {BEST} 0.800, p " in capsys.readouterr().out
    kept.write_text("\n".join(lines[1:]))
    with pytest.raises(ConfigurationError, match="expected missions of one on random, got none"):
        write_choosing.main(["--judge", str(given)])

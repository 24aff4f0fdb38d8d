"""Entrants: what they are judged by, and files that are damaged or hostile, each refused in one line."""

import json
import re
from dataclasses import asdict
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
import pytest

from docs.comparison import enter, missions
from docs.comparison.enter import ENTRANT, main
from docs.comparison.manifest import Manifest
from docs.comparison.missions import Judged
from selector.documents.find import SHIPPED
from selector.documents.reading import as_yaml
from selforg import plugins
from tests.attacks.hostile import bomb
from tests.attacks.test_damage import onnx_model

GOAL = "AvoidCollision+ExplorationPatrol"
MANIFEST = {
    "name": "small",
    "page": True,
    "goal": GOAL,
    "seed": 5,
    "strategies": {"recent-finds": "fsm:recent-finds", "told-bumpers": "fsm:told-bumpers"},
    "families": {name: {"scenarios": 20, "fixed": ["ORCA+LevyWalk"]} for name in ("clustered", "bumpers-or-not-1")},
}
MACHINE = "goal: AvoidCollision+ExplorationPatrol\nstart: go\nstates: {go: {option: ORCA+RecentFinds}}\n"
PLUGIN = """
import numpy as np
from clean_swarm_env.deciders.decider import OptionDecider

class Mine(OptionDecider):
    terms = ("heard",)

    def _choose(self, observations):
        print("chatter")
        return ANSWER
"""
CALM = PLUGIN.replace("ANSWER", "np.zeros(len(observations), dtype=np.int64)")
NAMES = {
    "observation_space": {":type:": "Box", "names": ["carrying", "idle"]},
    "action_space": {
        ":type:": "MultiDiscrete",
        "names": {"AvoidCollision": ["ORCA"], "ExplorationPatrol": ["RecentFinds"]},
    },
}


@pytest.fixture
def small(tmp_path, monkeypatch):
    """The file of a manifest whose missions are kept, but for those of entrants, which are invented."""
    manifest, known = Manifest(**MANIFEST), np.arange(10.0, 30.0)
    given, done = tmp_path / "small.yaml", []
    given.write_bytes(as_yaml(manifest.model_dump(mode="json", exclude_none=True)).encode())
    lines = [
        json.dumps(asdict(Judged(family, label, label, 5, known.tolist(), [], 0.0)))
        for family in manifest.families
        for label in manifest.run_on(family)
    ]
    given.with_suffix(".jsonl").write_text("\n".join(lines))

    def invented(asked, family, label):
        done.append((asked.seed, family, label))
        return Judged(family, label, label, asked.seed, (known * (0.7 if label == ENTRANT else 1.0)).tolist(), [], 0.0)

    monkeypatch.setattr(missions, "_judged", invented)
    monkeypatch.setattr(enter, "ROOT", tmp_path)
    monkeypatch.setenv(plugins.NAMED, "")
    yield given, done
    enter.DECIDERS.pop(ENTRANT, None)


def entered(file, small, capsys):
    """Return exit code, output and errors of the command."""
    try:
        main([str(file), "--manifest", str(small)])
    except SystemExit as ended:
        return (ended.code, *capsys.readouterr())
    return (0, *capsys.readouterr())


def zipped(**parts):
    content = BytesIO()
    with ZipFile(content, "w", ZIP_DEFLATED) as archive:
        for name, part in parts.items():
            archive.writestr(name.replace("_", "/").replace("-", "."), part)
    return content.getvalue()


def of_policy(folder="", **changes):
    """Return the zip of a policy that ships, with changes of `policy.json`."""
    shipped = SHIPPED / "policies" / "one"
    spec = json.loads((shipped / "policy.json").read_text()) | changes
    parts = {"policy-json": json.dumps(spec), "policy-safetensors": (shipped / "policy.safetensors").read_bytes()}
    return zipped(**{folder + name: part for name, part in parts.items()})


@pytest.mark.parametrize(
    ("name", "content"),
    [("m.yaml", MACHINE), ("m.zip", of_policy()), ("folder.zip", of_policy("one_")), ("m.py", CALM)],
)
def test_who_enters_is_judged_on_public_scenarios_and_on_those_of_the_own_file(name, content, small, tmp_path, capsys):
    given, done = small
    file = tmp_path / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    code, out, err = entered(file, given, capsys)
    assert code == 0, err
    assert ("code of others runs now" in err) == (name == "m.py")
    digest = enter.digest_of(file)
    own = int(digest[:8], 16)
    families, pair = list(MANIFEST["families"]), "fixed:ORCA+LevyWalk"
    assert done == [
        *((5, family, ENTRANT) for family in families),
        *((own, family, label) for family in families for label in (pair, ENTRANT)),
    ]
    assert out.startswith(f"{name}, sha256 {digest}\n\nScenarios of seed 5: `entrant` costs 0.700 [0.700, 0.700] of ")
    assert f"Scenarios of seed {own}: `entrant` costs 0.700 [0.700, 0.700] of the best pairs of 2 families: acc" in out
    assert (tmp_path / "results" / "entrants" / digest[:16] / "table.md").read_text() == out

    done.clear()
    assert entered(file, given, capsys)[:2] == (0, out)
    assert done == []


@pytest.mark.extra
def test_a_network_with_names_enters_and_its_names_count(small, tmp_path, capsys):
    pytest.importorskip("onnxruntime")
    file = tmp_path / "m.onnx"
    file.write_bytes(onnx_model())
    alone = enter.digest_of(file)
    assert "expected a model of " in entered(file, small[0], capsys)[2]
    file.with_suffix(".json").write_text(json.dumps(NAMES))
    assert enter.digest_of(file) != alone
    code, _, err = entered(file, small[0], capsys)
    assert code == 0, err


def test_what_was_done_before_ctrl_c_is_not_done_again(small, tmp_path, capsys, monkeypatch):
    file, (given, done) = tmp_path / "m.yaml", small
    file.write_text(MACHINE)
    invented = missions._judged

    def interrupted(asked, family, label):
        if len(done) == 3:
            raise KeyboardInterrupt
        return invented(asked, family, label)

    monkeypatch.setattr(missions, "_judged", interrupted)
    code, out, err = entered(file, given, capsys)
    assert (code, out) == (130, "")
    assert err.endswith("interrupted: what is done stays, and the same command goes on\n")
    monkeypatch.setattr(missions, "_judged", invented)
    assert entered(file, given, capsys)[0] == 0
    assert len(done) == len(set(done)) == 6


def test_a_file_that_changes_meanwhile_is_refused(small, tmp_path, capsys, monkeypatch):
    file, invented = tmp_path / "m.yaml", missions._judged
    file.write_text(MACHINE)
    monkeypatch.setattr(missions, "_judged", lambda *asked: file.write_text(MACHINE + "# 2") and invented(*asked))
    assert (
        "m.yaml: expected the content with which the missions began, got another" in entered(file, small[0], capsys)[2]
    )


EVIL = {"observation": {"terms": [{"name": "evil.py:Evil"}]}, "terms": []}


@pytest.mark.parametrize(
    ("name", "content", "line"),
    [
        ("m.exe", "", r"m\.exe: expected a file that ends in \.yaml, \.onnx, \.zip or \.py, got m\.exe"),
        ("none.yaml", None, r"none\.yaml: cannot be read \(No such file or directory\)"),
        ("m.yaml", "a" * (32 * 2**20 + 1), r"m\.yaml: expected at most 33554432 bytes, got more"),
        ("m.yaml", bomb(12, 12, "lol"), r"m\.yaml: .*(aliases|values|mapping)"),
        ("m.yaml", MACHINE.replace("ORCA+", "ORKA+"), r"clustered: machine: options: .*ORKA\+RecentFinds"),
        (
            "m.yaml",
            MACHINE.replace("AvoidCollision+Ex", "Ex"),
            r"clustered: .*made to decide ExplorationPatrol, got AvoidCollision\+Exp",
        ),
        (
            "m.yaml",
            MACHINE + "probing: {robots: 9, option: ORCA+LevyWalk, until: heard_x}\n",
            "expected at most|heard_x",
        ),
        pytest.param(
            "m.onnx",
            onnx_model()[:40],
            r"m\.onnx: expected a model of \d+ numbers and \d+ options, got .*",
            marks=pytest.mark.extra,
        ),
        ("m.zip", b"PK no zip", r"m\.zip: expected a zip of policy\.json and policy\.safetensors, of .*not a zip file"),
        ("m.zip", of_policy()[:-30], r"m\.zip: expected a zip of policy\.json and .*not a zip file"),
        ("m.zip", of_policy("--_"), r"m\.zip: expected a zip of policy\.json and .*got \{'\.\./policy\.json': \d+, "),
        ("m.zip", zipped(data=b"{}", policy_pth=b""), r"m\.zip: expected a zip of policy\.json .*got \{'data': 2, "),
        ("m.zip", zipped(**{"policy-json": b"{}", "policy-safetensors": bytes(2**25 + 1)}), r"m\.zip: .*: 33554433\}"),
        ("m.zip", of_policy(mean=[0.0]), r"policy\.json: .*mean: expected \d+ numbers"),
        ("m.zip", of_policy(**EVIL), r"only a file asks to import evil\.py:Evil|evil"),
        ("m.py", "raise RuntimeError('no')", r"m\.py:1: RuntimeError: no"),
        ("m.py", "import sys; sys.exit(0)", r"m\.py:1: SystemExit: 0"),
        ("m.py", "def (", r"m\.py:1: SyntaxError"),
        ("m.py", "x = 1", r"m\.py: expected one class below OptionDecider, got none"),
        (
            "m.py",
            CALM + CALM.replace("Mine", "Other"),
            r"m\.py: expected one class below OptionDecider, got Mine, Other",
        ),
    ],
)
def test_what_is_damaged_or_hostile_is_one_line(name, content, line, small, tmp_path, capsys, monkeypatch):
    if name == "m.onnx":
        pytest.importorskip("onnxruntime")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "evil.py").write_text("raise RuntimeError('this runs')")
    if content is not None:
        (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    code, out, err = entered(name, small[0], capsys)
    *notes, told = err.splitlines()
    assert (code, out) == (2, "")
    assert told.startswith("error: ")
    assert re.search(line, told), told
    assert "this runs" not in err
    assert notes == ["m.py: code of others runs now, and may do whatever you may"] * (name == "m.py")
    assert small[1] == []
    assert {path.name for path in tmp_path.parent.iterdir() if "policy" in path.name} == set()


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        ("np.full(len(observations), np.nan)", "expected the number of an option for each row, got "),
        ("np.full(len(observations), 1000)", "expected the number of an option for each row, got "),
        ("np.zeros(3, dtype=int)", "expected the number of an option for each row, got "),
        ("None", "expected the number of an option for each row, got others"),
        ("observations.nothing", "AttributeError: "),
    ],
)
def test_wrong_answers_of_a_plug_in_are_one_line(answer, words, small, tmp_path, capsys, monkeypatch):
    file = tmp_path / "wrong.py"
    file.write_text(PLUGIN.replace("ANSWER", answer))

    def asked_once(manifest, family, label):
        monkeypatch.undo()
        return missions._judged(manifest, family, label)

    monkeypatch.setattr(missions, "_judged", asked_once)
    code, out, err = entered(file, small[0], capsys)
    assert (code, out) == (2, "")
    assert words in err.splitlines()[-1]

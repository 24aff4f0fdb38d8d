"""What is known from the words alone is told before libraries are imported that take seconds."""

import json
import subprocess
import sys

import pytest

from tests.paths import ROOT
from train.cli.listing import LISTED_KINDS

SLOW = ("numpy", "numba", "pymunk", "scipy", "matplotlib", "torch", "pettingzoo")
MISTAKES = [
    ("evaluate tabel1", "did you mean 'table1'"),
    ("evaluate crowdde", "did you mean 'crowded'"),
    ("evaluate crowded --strategy policy:exploring-pp", "did you mean 'exploring-ppo'"),
    ("evaluate crowded --strategy mine=fsm:finds+fsm:find", "unknown machine 'fsm:find'"),
    ("evaluate crowded --knowledge avoidanc", "did you mean 'avoidance'"),
    ("evaluate crowded --strategy MaxScor", "did you mean 'MaxScore'"),
    ("evaluate crowded --strategy policy:none.zip", "none.zip: cannot be read"),
    ("evaluate --condition Repulsion", "unknown condition 'Repulsion'"),
    ("evaluate crowded --strategy fixed:Nope+ExplorationPatrol", "unknown option 'Nope'"),
    ("evaluate crowded --strategy fixed:OR", "did you mean 'ORCA'"),
    ("evaluate crowded --strategy mine=fixed:ORCAA", "did you mean 'ORCA'"),
    ("evaluate crowded --strategy models:fly=fixed:Nope;go=fixed:ORCA", "unknown option 'Nope'"),
    ("evaluate crowded --strategy models:fly=policy:nope.zip", "nope.zip: cannot be read"),
    ("evaluate crowded --strategy mine=policy:one+no", "unknown policy 'no'"),
    ("play crowdet", "did you mean 'crowded'"),
    ("play crowded --strategy fixed:Nope", "unknown option 'Nope'"),
    ("play crowded --strategy policy:nope.zip", "nope.zip: cannot be read"),
    ("evaluate --starts none.json", "none.json: cannot be read"),
    ("evaluate --strategy fixed --starts x.json", "--starts: expected with an experiment"),
    ("evaluate robustnes", "did you mean 'robustness'"),
    ("evaluate --learn --workers 2", "--workers: expected 1 with --learn"),
    ("train ppo --config exploring-pp", "did you mean 'exploring-ppo'"),
    ("train es --config ess", "did you mean 'es'"),
    ("evaluate Foragin", "did you mean 'Foraging'"),
    ("explain none --robot 0 --time 1", "none: cannot be read"),
    (f"report {'long' * 100}", "File name too long"),
    ("record none --output none.swarm", "none: cannot be read"),
    ("replay none --html none.html", "none: cannot be read"),
    ("video none none.webp", "none: cannot be read"),
    ("report none", "none: cannot be read"),
    ("look picture none none.png --time 1", "none: cannot be read"),
    ("list familys", "did you mean 'families'"),
]
LISTS = [(f"list {kind}".strip(), "") for kind in ("", "strategies", "classes", "terms", "tasks")]
CODE = """
import io, json, sys
from contextlib import redirect_stderr, redirect_stdout
from train.cli.app import run_app
for line in json.loads(sys.stdin.read()):
    before = set(sys.modules)
    sys.argv = ["clean-swarm", *line.split()]
    with redirect_stdout(io.StringIO()) as said, redirect_stderr(said):
        try:
            run_app()
        except SystemExit as end:
            code = end.code
    print(json.dumps([code, said.getvalue(), sorted(sys.modules.keys() - before)]))
"""
"""Runs commands in turn; prints the code of each, what it said, and the modules that it imported first."""
REGISTERED = """
import json
from clean_swarm_env.learning.observation.config import TERMS
from selector.strategies.registry import STRATEGIES
from selforg.mechanisms import MECHANISMS
names = {"strategies": STRATEGIES.names(), "classes": MECHANISMS.names(), "terms": TERMS.names()}
print(json.dumps(names))
"""
"""What we ship, in a process in which no test registers anything."""


@pytest.fixture(scope="module")
def told():
    """What each command of `MISTAKES` and `LISTS` comes to in one process: code, output, slow libraries."""
    lines = [words for words, _ in MISTAKES + LISTS]
    given = {"input": json.dumps(lines), "cwd": ROOT, "text": True}
    out = subprocess.run([sys.executable, "-c", CODE], **given, stdout=subprocess.PIPE, check=True).stdout
    ended = map(json.loads, out.splitlines())
    return {line: (code, said, set(SLOW) & set(new)) for line, (code, said, new) in zip(lines, ended, strict=True)}


@pytest.mark.parametrize(("words", "expected"), MISTAKES, ids=[words for words, _ in MISTAKES])
def test_a_mistake_in_the_words_is_told_before_slow_libraries_are_imported(told, words, expected):
    code, said, imported = told[words]
    assert (code, imported) == (2, set())
    assert expected in said
    assert len(said.strip().splitlines()) == 1
    assert len(said) < 400


def test_the_list_imports_nothing_slow_and_names_all_that_is_registered(told):
    assert all((code, imported) == (0, set()) for code, _, imported in (told[words] for words, _ in LISTS))
    kinds = {line.split()[0]: int(line.split()[1]) for line in told["list"][1].strip().splitlines()[:-2]}
    known = json.loads(subprocess.check_output([sys.executable, "-c", REGISTERED], cwd=ROOT, text=True))
    for (kind, names), part in zip(known.items(), ("strategy-classes", "mechanism-classes", "terms"), strict=True):
        rows = [line.split() for line in told[f"list {kind}"][1].splitlines() if line[:1].strip()]
        assert [name for name, of, *_ in rows if of == part] == sorted(names)
        assert kinds[kind] == len(rows) - len(LISTED_KINDS[kind])  # the last lines say what the parts are
    assert "12 robots bring food" in told["list tasks"][1]

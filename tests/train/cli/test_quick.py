"""What is known from the words alone is told before libraries are imported that take seconds."""

import json
import subprocess
import sys

import pytest

from tests.paths import ROOT

SLOW = ("numpy", "numba", "pymunk", "scipy", "matplotlib", "torch", "pettingzoo")
QUICK = [
    ("evaluate crowded --knowledge avoidanc", "did you mean 'avoidance'"),
    ("evaluate --starts none.json", "none.json: cannot be read"),
    ("evaluate --learn --workers 2", "--workers: expected 1 with --learn"),
    ("train ppo --config exploring-pp", "did you mean 'exploring-ppo'"),
    ("train es --config ess", "did you mean 'es'"),
    ("explain none --robot 0 --time 1", "none: cannot be read"),
    (f"report {'long' * 70}", "File name too long" if sys.version_info < (3, 14) else "cannot be read (No such file"),
    ("record none --output none.swarm", "none: cannot be read"),
    ("replay none --html none.html", "none: cannot be read"),
    ("video none none.webp", "none: cannot be read"),
    ("report none", "none: cannot be read"),
    ("look picture none none.png --time 1", "none: cannot be read"),
    ("list familys", "did you mean 'families'"),
]
MISTAKES = [
    ("evaluate tabel1", "did you mean 'table1'"),
    ("evaluate crowdde", "did you mean 'crowded'"),
    ("evaluate crowded --strategy policy:exploring-pp", "did you mean 'exploring-ppo'"),
    ("evaluate clustered --strategy mine=fsm:recent-finds+find", "unknown machine 'find'"),
    ("evaluate crowded --strategy MaxScor", "did you mean 'MaxScore'"),
    ("evaluate crowded --strategy policy:none.zip", "none.zip: no such file"),
    ("evaluate --condition Repulsion", "unknown condition 'Repulsion'"),
    ("evaluate crowded --strategy fixed:Nope+ExplorationPatrol", "unknown option 'Nope+ExplorationPatrol'"),
    ("evaluate crowded --strategy fixed:OR", "did you mean 'ORCA'"),
    ("evaluate crowded --strategy mine=fixed:ORCAA", "did you mean 'ORCA'"),
    ("evaluate crowded --strategy models:robot=fixed:Nope", "unknown option 'Nope'"),
    ("evaluate crowded --strategy models:robot=policy:nope.zip", "nope.zip: no such file"),
    ("evaluate clustered --strategy mine=policy:one+no", "unknown policy 'no'"),
    ("play crowdet", "did you mean 'crowded'"),
    ("play crowded --strategy fixed:Nope", "unknown option 'Nope'"),
    ("play crowded --strategy policy:nope.zip", "nope.zip: no such file"),
    ("evaluate robustnes", "did you mean 'robustness'"),
    ("evaluate Foragin", "did you mean 'Foraging'"),
    ("evaluate crowded --strategy fixed --scenarios 1 --condition A", "--condition: expected with an experiment"),
    ("evaluate --goal X", "--goal: expected with strategies"),
    ("evaluate robustness --learn --store x", "expected with experiments without disturbances"),
]
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


@pytest.fixture(scope="module")
def told():
    """What each command of `QUICK` and `MISTAKES` comes to in one process: code, output, slow libraries."""
    lines = [words for words, _ in QUICK + MISTAKES]
    given = {"input": json.dumps(lines), "cwd": ROOT, "text": True}
    out = subprocess.run([sys.executable, "-c", CODE], **given, stdout=subprocess.PIPE, check=True).stdout
    ended = map(json.loads, out.splitlines())
    return {line: (code, said, set(SLOW) & set(new)) for line, (code, said, new) in zip(lines, ended, strict=True)}


@pytest.mark.parametrize(("words", "expected"), QUICK, ids=[words for words, _ in QUICK])
def test_a_mistake_in_the_words_is_told_before_slow_libraries_are_imported(told, words, expected):
    code, said, imported = told[words]
    assert (code, imported) == (2, set())
    assert expected in said
    assert len(said.strip().splitlines()) == 1
    assert len(said) < 400


@pytest.mark.parametrize(("words", "expected"), MISTAKES, ids=[words for words, _ in MISTAKES])
def test_a_wrong_name_is_told_in_one_line(told, words, expected):
    code, said, _ = told[words]
    assert code == 2
    assert expected in said
    assert len(said.strip().splitlines()) == 1
    assert len(said) < 400

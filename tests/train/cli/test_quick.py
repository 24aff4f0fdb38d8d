"""What is known from the words alone is told before libraries are imported that take seconds."""

import json
import subprocess
import sys

import pytest

from tests.paths import ROOT

SLOW = ("numpy", "numba", "pymunk", "scipy", "matplotlib", "torch", "pettingzoo")
CODE = f"""
import sys
from train.cli.app import run_app
try:
    run_app()
finally:
    print("imported", *[name for name in {SLOW} if name in sys.modules])
"""


def told(*words):
    """Run a command in a process of its own; return its code, what it said, and which slow libraries it imported."""
    done = subprocess.run([sys.executable, "-c", CODE, *words], cwd=ROOT, capture_output=True, text=True, check=False)
    said, _, imported = (done.stdout + done.stderr).partition("imported")
    return done.returncode, said + imported.partition("\n")[2], imported.partition("\n")[0].split()


REGISTERED = """
import json
from clean_swarm_env.learning.observation.config import TERMS
from clean_swarm_env.config.task_names import task_names
from selector.strategies.registry import STRATEGIES
from selforg.mechanisms import MECHANISMS
names = {"strategies": STRATEGIES.names(), "mechanisms": MECHANISMS.names()}
print(json.dumps(names | {"goals": sorted(task_names()), "terms": sorted(TERMS.names())}))
"""
"""What we ship, in a process in which no test registers anything."""
MISTAKES = [
    ("evaluate tabel1", "did you mean 'table1'"),
    ("evaluate --family crowdde", "did you mean 'crowded'"),
    ("evaluate --family crowded --strategy policy:exploring-pp", "did you mean 'exploring-ppo'"),
    ("evaluate --family crowded --strategy mine=fsm:finds+fsm:find", "unknown machine 'fsm:find'"),
    ("evaluate --family crowded --knowledge avoidanc", "did you mean 'avoidance'"),
    ("evaluate --family crowded --strategy MaxScor", "did you mean 'MaxScore'"),
    ("evaluate --family crowded --strategy policy:none.zip", "none.zip: cannot be read"),
    ("evaluate --condition Repulsion", "unknown condition 'Repulsion'"),
    ("evaluate --family crowded --strategy fixed:Nope+ExplorationPatrol", "unknown option 'Nope'"),
    ("evaluate --family crowded --strategy mine=fixed:ORCAA", "did you mean 'ORCA'"),
    ("evaluate --family crowded --strategy models:fly=fixed:Nope;go=fixed:ORCA", "unknown option 'Nope'"),
    ("evaluate --family crowded --strategy models:fly=policy:nope.zip", "nope.zip: cannot be read"),
    ("play crowdet", "did you mean 'crowded'"),
    ("play crowded --strategy fixed:Nope", "unknown option 'Nope'"),
    ("play crowded --strategy policy:nope.zip", "nope.zip: cannot be read"),
    ("evaluate --starts none.json", "none.json: cannot be read"),
    ("evaluate --strategy fixed", "--strategy: expected with --family only"),
    ("evaluate --learn --workers 2", "--workers: expected 1 with --learn"),
    ("train ppo --config exploring-pp", "did you mean 'exploring-ppo'"),
    ("train es --config ess", "did you mean 'es'"),
    ("tune keep-aprt", "did you mean 'keep-apart'"),
    ("study headroom crowdde", "did you mean 'crowded'"),
    ("run Foragin", "did you mean 'Foraging'"),
    ("explain none --robot 0 --time 1", "none: cannot be read"),
    ("record none --output none.swarm", "none: cannot be read"),
    ("replay none --html none.html", "none: cannot be read"),
    ("video none none.webp", "none: cannot be read"),
    ("report none", "none: cannot be read"),
    ("look picture none none.png --time 1", "none: cannot be read"),
]


@pytest.mark.parametrize(("words", "expected"), MISTAKES, ids=[words for words, _ in MISTAKES])
def test_a_mistake_in_the_words_is_told_before_slow_libraries_are_imported(words, expected):
    code, said, imported = told(*words.split())
    assert (code, imported) == (2, [])
    assert expected in said
    assert len(said.strip().splitlines()) == 1


def test_the_list_imports_nothing_slow_and_names_all_that_is_registered():
    code, said, imported = told("list")
    assert (code, imported) == (0, [])
    kinds = {line.split()[0]: int(line.split()[1]) for line in said.strip().splitlines()[:-2]}
    known = json.loads(subprocess.check_output([sys.executable, "-c", REGISTERED], cwd=ROOT, text=True))
    for kind, names in (("strategy-classes", "strategies"), ("mechanism-classes", "mechanisms"), ("terms", "terms")):
        code, said, imported = told("list", kind)
        assert (code, imported) == (0, [])
        assert [line.split()[0] for line in said.splitlines() if line[:1].strip()][:-1] == sorted(known[names])
        assert kinds[kind] == len(known[names])
    assert "12 robots bring food" in told("list", "tasks")[1]


def test_an_unknown_kind_is_one_line():
    code, said, imported = told("list", "familys")
    assert (code, imported) == (2, [])
    assert "did you mean 'families'" in said
    assert len(said.strip().splitlines()) == 1

"""PettingZoo's own tests, with every kind of actions, on every kind of missions and on every task."""

from functools import partial
from itertools import product
from types import SimpleNamespace

import pytest
from pettingzoo.test import api_test, max_cycles_test, parallel_api_test, parallel_seed_test, seed_test
from pettingzoo.test.state_test import state_test

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.tasks import TASKS
from clean_swarm_env.wrappers import AllRobots, MaskedObservations
from selector.documents.find import files_of
from tests.clean_swarm_env.borders.test_changing_agents import EVENTS
from tests.clean_swarm_env.courses import mission

OPEN, GOALS = "a team that changes", "exploring"
"""A mission whose robots come and go, and one with several coordinated goals."""
KINDS = (*sorted(files_of("missions")), *TASKS.names(), OPEN)
MODES = ("option", "velocity", "both")
GATE = {*product(["table1"], MODES), *product((OPEN, GOALS, "FormationControl"), ["both"])}
"""Every kind of actions, and every kind of missions with the actions that have all parts; `make long` has the rest."""
ASIDE = {max_cycles_test: (OPEN,)}
"""Test -> kinds on which it cannot pass. It expects that most possible agents act in all steps: some join later."""


def of(kind, mode, maker=clean_swarm_v0.parallel_env, seconds=12.0, **settings):
    changed = mission(events=EVENTS, time_limit=seconds) if kind == OPEN else {"base": kind, "time_limit": seconds}
    return maker(changed, action={"mode": mode}, **settings)


@pytest.mark.filterwarnings("ignore::UserWarning")  # remarks, such as on observations that are no pictures
@pytest.mark.parametrize(
    ("kind", "mode"),
    [pytest.param(*one, marks=[] if one in GATE else pytest.mark.long) for one in product(KINDS, MODES)],
)
def test_pettingzoos_own_tests_pass(kind, mode):
    parallel, turns = partial(of, kind, mode), partial(of, kind, mode, clean_swarm_v0.env)
    parallel_api_test(parallel(), num_cycles=20)
    api_test(turns(), num_cycles=14)
    seed_test(turns, num_cycles=4)
    parallel_seed_test(parallel, num_cycles=4)
    state_test(turns(), parallel(), num_cycles=4)
    if kind not in ASIDE[max_cycles_test]:
        max_cycles_test(SimpleNamespace(parallel_env=parallel, env=turns))
    parallel_api_test(AllRobots(parallel()), num_cycles=14)
    if mode != "velocity":
        parallel_api_test(MaskedObservations(AllRobots(parallel())), num_cycles=14)

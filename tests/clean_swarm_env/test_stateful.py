"""Whatever is done to an environment in whatever order, its further course is that of a twin that was left alone."""

import copy
import pickle
import tempfile
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.recording.reader import NoFrames, RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from tests.clean_swarm_env.copies import MISSIONS
from tests.clean_swarm_env.courses import mission
from tests.clean_swarm_env.soak_states import damaged

KINDS = {
    "avoidance": {"mission": mission(garbage={"count": 2}, time_limit=20.0)},
    "events": {"family": "shifting"},
    "own contents": {"mission": MISSIONS["own contents"]},
    "task": {"mission": {"task": "MaxValue"}},
}


class Course(RuleBasedStateMachine):
    """An environment that is copied, pickled, given states and recorded, beside a twin that only resets and steps."""

    @initialize(kind=st.sampled_from(list(KINDS)), recorded=st.booleans(), seed=st.integers(0, 9))
    def make(self, kind, recorded, seed):
        self.folder = tempfile.TemporaryDirectory()
        self.recorded, made = recorded, KINDS[kind]
        settings = {"record": RecordSettings(Path(self.folder.name))} if recorded else {}
        self.env = clean_swarm_v0.parallel_env(**made, **settings)
        self.twin = clean_swarm_v0.parallel_env(**made)
        self.states = []  # with the twins that were left alone since then
        self.reset(seed)

    @rule(seed=st.integers(0, 9))
    def reset(self, seed):
        seen, expected = self.env.reset(seed=seed)[0], self.twin.reset(seed=seed)[0]
        assert_same(seen, expected)

    @rule(count=st.integers(1, 8), seed=st.integers(0, 99))
    def step(self, count, seed):
        options = np.random.default_rng(seed).integers(2, size=(count, len(self.env.possible_agents)))
        for row in options:
            actions = dict(zip(self.env.possible_agents, row, strict=True))
            if self.env.agents:
                answers = [one.step({agent: actions[agent] for agent in one.agents}) for one in (self.env, self.twin)]
                assert_same(*(answer[0] for answer in answers))
                assert [answer[1:4] for answer in answers[:1]] == [answer[1:4] for answer in answers[1:]]

    @rule()
    def save(self):
        self.states.append((self.env.get_state(), copy.deepcopy(self.twin)))

    @precondition(lambda self: self.states)
    @rule(number=st.integers(0, 99))
    def go_back(self, number):
        state, twin = self.states[number % len(self.states)]
        if self.recorded:
            with pytest.raises(ValueError, match="set_state: expected a batch that records nothing"):
                self.env.set_state(state)
        else:
            self.env.set_state(state)
            self.twin = copy.deepcopy(twin)

    @rule(seed=st.integers(0, 999))
    def go_on_from_damage(self, seed):
        state, others = self.twin.get_state(), [state for state, _ in self.states] or [b"other"]
        broken = damaged(state, others[0], np.random.default_rng(seed))
        if broken not in (state, others[0]):
            with pytest.raises(ValueError, match=r"^(set_)?state: expected [^\n]*$"):
                self.env.set_state(broken)

    @rule(way=st.sampled_from([copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))]))
    def copied(self, way):
        if self.recorded:
            with suppress(TypeError):  # raised once frames are recorded
                way(self.env)
        else:
            self.env = way(self.env)

    @invariant()
    def same_agents(self):
        if hasattr(self, "env"):
            assert self.env.agents == self.twin.agents

    def teardown(self):
        if hasattr(self, "env"):
            self.env.close()
            for path in Path(self.folder.name).glob("*.swarm"):
                with suppress(NoFrames):  # reset, and no step
                    assert RecordedMission(path).frames > 0
            self.folder.cleanup()


def assert_same(seen, expected):
    assert seen.keys() == expected.keys()
    assert all(np.array_equal(seen[agent], expected[agent]) for agent in seen)


TestCourse = Course.TestCase
TestCourse.settings = settings(
    max_examples=8,
    stateful_step_count=12,
    derandomize=True,
    phases=[Phase.generate],  # a failure is not made smaller, which takes minutes
    suppress_health_check=list(HealthCheck),
)

"""A task below one that ships, as docs/own_task.md has it, keeps what it defines itself."""

import numpy as np

from clean_swarm_env.config.tasks import TASKS
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks.cleaning.task import Cleaning
from selforg.components.facts import FactRule


def test_a_task_below_cleaning_is_asked_in_each_tick_what_its_robots_notice(monkeypatch):
    monkeypatch.setattr(TASKS, "_classes", dict(TASKS._classes))
    asked = []

    class Tiring(Cleaning):
        """Cleaning by robots that notice that they are tired."""

        notices = {"tired": FactRule(means="that it is tired")}  # noqa: RUF012

        def noticed(self):
            asked.append(self.world.now)
            return {"tired": np.ones(2, np.bool_)}

    TASKS.register(Tiring)
    batch = Batch({"name": "x", "task": "Tiring", "robots": {"count": 2}})
    batch.worlds.minds.share(Tiring.notices)
    batch.reset(1)
    batch.step(np.zeros((batch.rows, len(batch.options)), np.int64))
    assert len(asked) == 5

"""Contract tests for classes of your own, each by one line: a check raises one line for what a class does not keep.

    from clean_swarm_env.testing import check_mechanism

    def test_my_mechanism():
        check_mechanism(KeepDistance, view_distance=2.0)

The tests of this project check all registered classes by the same functions. docs/own_plugins.md says which there are.
"""

from clean_swarm_env.testing.components import check_action as check_action
from clean_swarm_env.testing.components import check_activator as check_activator
from clean_swarm_env.testing.components import check_sensor as check_sensor
from clean_swarm_env.testing.learning import check_reward_term as check_reward_term
from clean_swarm_env.testing.learning import check_term as check_term
from clean_swarm_env.testing.mechanisms import check_mechanism as check_mechanism
from clean_swarm_env.testing.strategies import check_strategy as check_strategy
from clean_swarm_env.testing.tasks import check_task as check_task

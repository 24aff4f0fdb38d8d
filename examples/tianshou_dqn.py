"""DQN of Tianshou, one network for each robot, with masks, in a team that changes.

pip install -c constraints.txt tianshou==2.0.1 .
python examples/tianshou_dqn.py --epochs 10
clean-swarm evaluate table1-starts --strategy fixed --strategy policy:tianshou_dqn.pt --scenarios 10
"""

import argparse

from pettingzoo.utils.conversions import parallel_to_aec
from robot_policy import save
from tianshou.algorithm.modelfree.dqn import DQN, DiscreteQLearningPolicy
from tianshou.algorithm.multiagent.marl import MultiAgentOffPolicyAlgorithm
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Collector, VectorReplayBuffer
from tianshou.env import DummyVectorEnv, PettingZooEnv
from tianshou.trainer import OffPolicyTrainerParams
from tianshou.utils.net.common import Net

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.wrappers import AllRobots, MaskedObservations

EVENTS = [{"at": 30.0, "do": "fail", "robots": [1]}]
MISSION = {"base": "table1", "task": {"garbage": {"count": 4}}, "time_limit": 100.0, "events": EVENTS}
SERVES = {"RepulsionFernandez-view2.0": ["patrol", "approach"]}


def make() -> PettingZooEnv:
    """Return the environment in which robots act one after the other, with masks."""
    swarm = clean_swarm_v0.parallel_env(MISSION, knowledge="avoidance", action={"serves": SERVES})
    return PettingZooEnv(parallel_to_aec(MaskedObservations(AllRobots(swarm))))


def learner(env: PettingZooEnv) -> DQN:
    """Return the learner of one robot."""
    seen = env.observation_space["observation"]
    policy = DiscreteQLearningPolicy(
        model=Net(state_shape=seen.shape, action_shape=env.action_space.n, hidden_sizes=(64, 64)),
        action_space=env.action_space,
        observation_space=seen,
        eps_training=0.1,
    )
    return DQN(policy=policy, optim=AdamOptimizerFactory(lr=1e-3), gamma=0.98, target_update_freq=200)


def main() -> None:
    """Train and print the mean returns of the robots."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--epochs", type=int, default=10)
    parser.add_argument("--steps", type=int, default=1000, help="decisions of an epoch")
    given = parser.parse_args()
    env = make()
    algorithm = MultiAgentOffPolicyAlgorithm(algorithms=[learner(env) for _ in env.agents], env=env)
    collector = Collector(algorithm, DummyVectorEnv([make]), VectorReplayBuffer(20_000, 1), exploration_noise=True)
    settings = OffPolicyTrainerParams(
        max_epochs=given.epochs,
        epoch_num_steps=given.steps,
        training_collector=collector,
        test_collector=None,
        collection_step_num_env_steps=100,
        batch_size=64,
        update_step_num_gradient_steps_per_sample=0.2,
    )
    collector.reset()
    collector.collect(n_step=500)
    print(algorithm.run_training(settings))
    collector.reset()
    print("returns of the robots:", collector.collect(n_episode=3).returns.mean(axis=0))
    width = env.observation_space["observation"].shape[0]
    robot = algorithm.get_algorithm(env.agents[0]).policy.model
    save(robot, width - 1, "tianshou_dqn.pt", lambda net, seen: net(seen)[0])


if __name__ == "__main__":
    main()

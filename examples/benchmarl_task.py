"""BenchMARL: the cleaning swarm as a task, for MAPPO and IPPO, QMIX with masks and global state, MASAC with vectors.

pip install -c constraints.txt benchmarl==1.5.2 torchrl==0.11.1 .
python examples/benchmarl_task.py mappo --frames 60000
clean-swarm evaluate table1-starts --strategy policy:benchmarl.pt --scenarios 10  (velocity: after masac)
"""

import argparse
from collections.abc import Callable

from benchmarl.algorithms import IppoConfig, MappoConfig, MasacConfig, QmixConfig
from benchmarl.environments.pettingzoo.common import PettingZooClass
from benchmarl.experiment import Experiment, ExperimentConfig
from benchmarl.models.mlp import Mlp, MlpConfig
from robot_policy import save
from torchrl.envs import EnvBase, PettingZooWrapper

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.wrappers import AllRobots

EVENTS = [{"at": 30.0, "do": "fail", "robots": [1]}, {"at": 60.0, "do": "join", "robots": 1}]
MISSION = {"base": "table1", "task": {"garbage": {"count": 4}}, "knowledge": "avoidance", "events": EVENTS}
SERVES = {"RepulsionFernandez-view2.0": ["patrol", "approach"]}
ALGORITHMS = {"mappo": MappoConfig, "ippo": IppoConfig, "qmix": QmixConfig, "masac": MasacConfig}


class CleanSwarmTask(PettingZooClass):
    """Missions with a changing team; the configuration has the arguments of `parallel_env`."""

    def get_env_fun(
        self, num_envs: int, continuous_actions: bool, seed: int | None, device: str
    ) -> Callable[[], EnvBase]:
        """Return a function that makes an environment."""
        action = {"mode": "velocity"} if continuous_actions else {"serves": SERVES}

        def make() -> EnvBase:
            env = AllRobots(clean_swarm_v0.parallel_env(action=action, **self.config))
            settings = {"categorical_actions": True, "done_on_any": False, "seed": seed, "device": device}
            return PettingZooWrapper(env, return_state=True, group_map=env.agents_by_model, **settings)

        return make

    def has_state(self) -> bool:
        """Return True: there is a global state, and there are both kinds of actions."""
        return True

    supports_continuous_actions = supports_discrete_actions = has_state


def main() -> None:
    """Train by one algorithm and print the mean return."""
    parser = argparse.ArgumentParser()
    parser.add_argument("algorithm", choices=ALGORITHMS)
    parser.add_argument("--frames", type=int, default=60_000)
    parser.add_argument("--batch", type=int, default=1000)
    given = parser.parse_args()
    settings = ExperimentConfig.get_from_yaml()
    settings.loggers, settings.evaluation, settings.create_json = [], False, False
    settings.prefer_continuous_actions = given.algorithm == "masac"
    settings.max_n_frames, settings.gamma, settings.off_policy_n_optimizer_steps = given.frames, 0.98, 100
    settings.on_policy_collected_frames_per_batch = settings.off_policy_collected_frames_per_batch = given.batch
    experiment = Experiment(
        task=CleanSwarmTask("CLEAN_SWARM", {"mission": MISSION, "max_cycles": 100}),
        algorithm_config=ALGORITHMS[given.algorithm].get_from_yaml(),
        model_config=MlpConfig.get_from_yaml(),
        seed=1,
        config=settings,
    )
    experiment.run()
    print(f"{given.algorithm}: mean return of the last batch {experiment.mean_return:.3f}")
    network = next(module.mlp for module in experiment.policy.modules() if isinstance(module, Mlp))
    width = experiment.observation_spec["robot", "observation"].shape[-1]
    vector = (lambda called, seen: called(seen)[..., :2].tanh()) if settings.prefer_continuous_actions else None
    save(network.get_stateful_net(), width - 1, "benchmarl.pt", vector)


if __name__ == "__main__":
    main()

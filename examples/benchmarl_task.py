"""BenchMARL: the cleaning swarm as a task, for MAPPO and IPPO, QMIX with masks and global state, MASAC with vectors.

pip install benchmarl && pip install .
python examples/benchmarl_task.py mappo --frames 60000
"""

import argparse
from collections.abc import Callable

from benchmarl.algorithms import IppoConfig, MappoConfig, MasacConfig, QmixConfig
from benchmarl.environments.pettingzoo.common import PettingZooClass
from benchmarl.experiment import Experiment, ExperimentConfig
from benchmarl.models.mlp import MlpConfig
from torchrl.envs import EnvBase, PettingZooWrapper

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.wrappers import AllRobots

MISSION = {"base": "table1", "garbage": {"count": 4}}
ALGORITHMS = {"mappo": MappoConfig, "ippo": IppoConfig, "qmix": QmixConfig, "masac": MasacConfig}

WRAPPED = {"return_state": True, "categorical_actions": True, "done_on_any": False}


class CleanSwarmTask(PettingZooClass):
    """Missions with a changing team; the configuration has the arguments of `parallel_env`."""

    def get_env_fun(
        self, num_envs: int, continuous_actions: bool, seed: int | None, device: str
    ) -> Callable[[], EnvBase]:
        """Return a function that makes an environment."""
        action = {"mode": "velocity" if continuous_actions else "option"}

        def make() -> EnvBase:
            env = AllRobots(clean_swarm_v0.parallel_env(action=action, **self.config))
            return PettingZooWrapper(env, seed=seed, device=device, **WRAPPED)

        return make

    def supports_continuous_actions(self) -> bool:
        """Return True: movement vectors."""
        return True

    def supports_discrete_actions(self) -> bool:
        """Return True: options."""
        return True

    def has_state(self) -> bool:
        """Return True: the global state."""
        return True


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
    settings.max_n_frames, settings.gamma = given.frames, 0.98
    settings.on_policy_collected_frames_per_batch = settings.off_policy_collected_frames_per_batch = given.batch
    settings.off_policy_n_optimizer_steps = 100
    experiment = Experiment(
        task=CleanSwarmTask("CLEAN_SWARM", {"mission": MISSION, "max_cycles": 100}),
        algorithm_config=ALGORITHMS[given.algorithm].get_from_yaml(),
        model_config=MlpConfig.get_from_yaml(),
        critic_model_config=MlpConfig.get_from_yaml(),
        seed=1,
        config=settings,
    )
    experiment.run()
    print(f"{given.algorithm}: mean return of the last batch {experiment.mean_return:.3f}")


if __name__ == "__main__":
    main()

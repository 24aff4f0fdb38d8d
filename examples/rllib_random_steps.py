"""1,000 random steps and one PPO iteration through RLlib's PettingZoo wrapper.

RLlib pins other versions than this project and so needs an environment of its own:

    python3 -m venv rllib && rllib/bin/pip install 'ray[rllib]' torch && rllib/bin/pip install --no-deps clean-swarm
    rllib/bin/pip install numba 'pettingzoo>=1.27' pydantic pyyaml typer rich scipy matplotlib sqlalchemy
    rllib/bin/python examples/rllib_random_steps.py
"""

from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.tune.registry import register_env

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.load import load_mission

STEPS = 1_000


def make(_: object = None) -> ParallelPettingZooEnv:
    """Return the environment with missions of 200 s."""
    mission = load_mission("table1").model_copy(update={"time_limit": 200.0})
    return ParallelPettingZooEnv(clean_swarm_v0.parallel_env(mission))


def random_steps() -> int:
    """Take the steps and return how many episodes ended."""
    env, ended = make(), 0
    env.reset(seed=1)
    for _ in range(STEPS):
        actions = {agent: env.get_action_space(agent).sample() for agent in env.par_env.agents}
        observations, rewards, terminations, truncations, _ = env.step(actions)
        assert observations.keys() == rewards.keys()
        if terminations["__all__"] or truncations["__all__"]:
            ended += 1
            env.reset()
    return ended


def learn() -> float:
    """Return the mean episode length of one iteration of PPO with one policy for all robots."""
    register_env("clean_swarm", make)
    config = (
        PPOConfig()
        .environment("clean_swarm")
        .env_runners(num_env_runners=0)
        .training(train_batch_size=1000, minibatch_size=250, num_epochs=2)
        .multi_agent(policies={"robot"}, policy_mapping_fn=lambda *_, **__: "robot")
    )
    algorithm = config.build_algo()
    result = algorithm.train()
    algorithm.stop()
    return float(result["env_runners"]["episode_len_mean"])


if __name__ == "__main__":
    print(f"{STEPS} random steps, {random_steps()} episodes ended")
    print(f"one PPO iteration, episodes of {learn():.0f} steps on average")

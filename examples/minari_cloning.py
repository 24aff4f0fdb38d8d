"""A Minari dataset of missions in which the selector chooses at random, with the figures of each mission in its infos.

pip install 'minari[hdf5,create]' && pip install .
python examples/minari_dataset.py --missions 10
"""

import argparse

import gymnasium
import minari
import numpy as np

import clean_swarm_env.registration  # noqa: F401  (registers the environment)

DATASET = "clean-swarm/team/random-v0"
DESCRIPTION = """Random options in the cleaning world: one selector gives each of five robots its way to avoid others.
Observations are those of all robots, one after the other; infos have the keys of the table in docs/environment.md."""


def main() -> None:
    """Record the missions, load the dataset again and print its figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--missions", type=int, default=10)
    missions = parser.parse_args().missions
    mission = {"base": "table1", "garbage": {"count": 4}, "time_limit": 100.0}
    env = minari.DataCollector(gymnasium.make("CleanSwarm-v0", mission=mission), record_infos=True)
    env.action_space.seed(1)
    for number in range(missions):
        env.reset(seed=number)
        over = False
        while not over:
            *_, terminated, truncated, _ = env.step(env.action_space.sample())
            over = terminated or truncated
    if DATASET in minari.list_local_datasets():
        minari.delete_dataset(DATASET)
    env.create_dataset(
        dataset_id=DATASET,
        algorithm_name="random options",
        description=DESCRIPTION,
        author="Clean Swarm",
    )
    dataset = minari.load_dataset(DATASET)
    episodes = list(dataset.iterate_episodes())
    done = [int(np.asarray(episode.infos["garbage_done"])[-1]) for episode in episodes]
    print(f"{dataset.total_episodes} missions, {dataset.total_steps} decisions, items dumped {done}")


if __name__ == "__main__":
    main()

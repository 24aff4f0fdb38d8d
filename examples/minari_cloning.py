"""Behaviour cloning: a network learns from a Minari dataset to decide as the strategy did that was recorded.

pip install -c constraints.txt 'minari[hdf5,create]==0.5.4' '.[train]'
clean-swarm learn dataset clean-swarm/rule-v0 --strategy fsm:rule --missions 10
python examples/minari_cloning.py clean-swarm/rule-v0
clean-swarm evaluate --family table1 --strategy fsm:rule --strategy policy:minari_cloning.pt --scenarios 10
"""

import argparse

import minari
import numpy as np
import torch
from torch import nn


def main() -> None:
    """Train and save `minari_cloning.pt`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("dataset")
    parser.add_argument("--epochs", type=int, default=200)
    given = parser.parse_args()
    torch.manual_seed(1)
    dataset = minari.load_dataset(given.dataset)
    episodes = list(dataset.iterate_episodes())
    taken = np.concatenate([episode.actions for episode in episodes])
    seen = np.concatenate([episode.observations[:-1] for episode in episodes])  # the last one has no action
    actions = torch.from_numpy(taken.reshape(-1))
    observations = torch.from_numpy(seen.reshape(len(actions), -1))  # robot by robot
    width, options = observations.shape[1], int(dataset.action_space.nvec[0])
    network = nn.Sequential(nn.Linear(width, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, options))
    optimiser = torch.optim.Adam(network.parameters(), lr=1e-3)
    for _ in range(given.epochs):
        loss = nn.functional.cross_entropy(network(observations), actions)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    alike = (network(observations).argmax(dim=1) == actions).float().mean()
    print(f"{len(episodes)} missions, {len(actions)} decisions of robots, {alike:.0%} decided alike")
    torch.jit.script(network).save("minari_cloning.pt")


if __name__ == "__main__":
    main()

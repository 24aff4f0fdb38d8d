"""Saves what a robot decides as TorchScript, for `clean-swarm evaluate --strategy policy:FILE.pt` (or velocity:)."""

from collections.abc import Callable

import torch
from torch import nn


class RobotPolicy(nn.Module):
    """The logits or values of one robot's options, or its vector, by a network that was trained with `AllRobots`."""

    def __init__(self, network: nn.Module, answer_of: Callable[[nn.Module, torch.Tensor], torch.Tensor]) -> None:
        super().__init__()
        self.network, self._answer_of = network, answer_of

    def forward(self, seen: torch.Tensor) -> torch.Tensor:
        """Return a number for each option (R, O), or vectors (R, 2), from observations (R, F)."""
        alive = nn.functional.pad(seen, (0, 1), value=1.0)  # the flag of `AllRobots`: robots that decide are at work
        return self._answer_of(self.network, alive)


def save(
    network: nn.Module,
    width: int,
    name: str,
    answer_of: Callable[[nn.Module, torch.Tensor], torch.Tensor] | None = None,
) -> None:
    """Write the file `name`; `width` is F without the flag, `answer_of` calls the network where that needs more."""
    policy = RobotPolicy(network.eval(), answer_of or (lambda called, seen: called(seen)))
    torch.jit.trace(policy, torch.rand(7, width)).save(name)

"""Saves what a robot decides as TorchScript, which `clean-swarm evaluate --strategy policy:FILE.pt` takes."""

from collections.abc import Callable

import torch
from torch import nn


class RobotPolicy(nn.Module):
    """The logits or values of one robot's options, by a network that was trained with `AllRobots`."""

    def __init__(self, network: nn.Module, options_of: Callable[[nn.Module, torch.Tensor], torch.Tensor]) -> None:
        super().__init__()
        self.network, self._options_of = network, options_of

    def forward(self, seen: torch.Tensor) -> torch.Tensor:
        """Return a number for each option (R, O) from observations (R, F)."""
        alive = nn.functional.pad(seen, (0, 1), value=1.0)  # the flag of `AllRobots`: robots that decide are at work
        return self._options_of(self.network, alive)


def save(
    network: nn.Module,
    width: int,
    name: str,
    options_of: Callable[[nn.Module, torch.Tensor], torch.Tensor] | None = None,
) -> None:
    """Write the file `name`; `width` is F without the flag, `options_of` calls the network where that needs more."""
    policy = RobotPolicy(network.eval(), options_of or (lambda called, seen: called(seen)))
    torch.jit.trace(policy, torch.rand(7, width)).save(name)

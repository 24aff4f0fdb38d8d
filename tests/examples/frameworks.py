"""The examples, the packages that they need, and how short a run shows that their parts fit."""

from typing import NamedTuple


class Example(NamedTuple):
    """A run of an example: its command, the package that it needs beside ours, and the strategy that it leaves."""

    command: str
    """File and arguments."""
    needs: str
    """Name by which the package is imported; the test is skipped where it is not installed."""
    strategy: str = ""
    """What `clean-swarm evaluate --strategy` takes afterwards."""
    before: str = ""
    """Arguments of a command of ours that goes before."""


EXAMPLES = (
    Example("ppo_one_file.py --updates 2 --worlds 4", "torch", "policy:ppo_one_file.pt"),
    Example("pufferlib_ppo.py --updates 2 --worlds 4", "pufferlib", "policy:pufferlib_ppo.pt"),
    Example("sb3_ppo.py --steps 5120", "stable_baselines3", "policy:sb3_ppo.zip"),
    Example("sb3_sac.py --steps 600", "stable_baselines3", "velocity:sb3_sac.zip"),
    Example("sb3_maskable_ppo.py --steps 5120", "sb3_contrib", "policy:sb3_maskable_ppo.zip"),
    Example("torchrl_mappo.py --frames 200 --batch 100", "torchrl", "policy:torchrl_mappo.pt"),
    Example("benchmarl_task.py mappo --frames 200 --batch 100", "benchmarl", "policy:benchmarl.pt"),
    Example("benchmarl_task.py ippo --frames 200 --batch 100", "benchmarl", "policy:benchmarl.pt"),
    Example("benchmarl_task.py qmix --frames 200 --batch 100", "benchmarl", "policy:benchmarl.pt"),
    Example("benchmarl_task.py masac --frames 200 --batch 100", "benchmarl", "velocity:benchmarl.pt"),
    Example("rllib_ppo.py --iterations 1", "ray", "policy:rllib_ppo.pt"),
    Example("tianshou_dqn.py --epochs 1 --steps 200", "tianshou", "policy:tianshou_dqn.pt"),
)

ENVIRONMENTS = {
    "sb3": ("sb3 or one_file or supersuit", "stable-baselines3==2.9.2", "sb3-contrib==2.9.2", "SuperSuit==3.11.0"),
    "torchrl": ("torchrl", "torchrl==0.14.1"),
    "benchmarl": ("benchmarl", "benchmarl==1.5.2", "torchrl==0.11.1"),  # it does not take later ones
    "rllib": ("rllib", "ray[rllib]==2.60.0"),
    "tianshou": ("tianshou", "tianshou==2.0.1"),
    "pufferlib": (
        "pufferlib_ppo",
        "gym==0.26.2",
        "psutil==7.2.2",
        "pyro-ppl==1.9.2",
        "rich-argparse==1.8.0",
        "setuptools",
    ),
    "plugin": ("plugin", "stable-baselines3==2.9.2", "tensorboard==2.21.0", "hatchling==1.33.0"),
    "notebook": ("notebook", "nbclient==0.11.0", "ipykernel==7.4.0"),
}
"""Virtual environment -> which tests run in it (pytest's -k), and its packages beside ours and torch, in the versions
with which the examples last ran: on 23 November 2026 the newest ones, except for the TorchRL of BenchMARL."""

BUILT = {"pufferlib": "pufferlib==3.0.0"}
"""Virtual environment -> a package that is built there without what it asks for, see docs/environment.md#pufferlib."""

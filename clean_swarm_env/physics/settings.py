"""Sizes of the worlds and of the robots in them, checked once."""

from dataclasses import dataclass
from math import isfinite, pi, sqrt
from typing import Final, Literal, get_args

Contacts = Literal["solid", "pass_through"]
DENSEST_PACKING: Final = pi / sqrt(12.0)  # share of the plane that equal discs can cover


@dataclass(frozen=True)
class PhysicsSettings:
    """Sizes of the worlds and their robots; impossible ones raise ValueError."""

    worlds: int  # W
    robots: int  # N, in each world
    width: float = 11.0  # [m]
    height: float = 11.0  # [m]
    radius: float = 0.25  # [m] of a robot's disc
    contacts: Contacts = "solid"  # "pass_through": robots drive through each other
    timestep: float = 0.05  # [s] of a substep

    def __post_init__(self) -> None:
        for name in ("worlds", "robots"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name}: expected at least 1, got {getattr(self, name)}")
        for name in ("width", "height", "radius", "timestep"):
            if not (getattr(self, name) > 0.0 and isfinite(getattr(self, name))):
                raise ValueError(f"{name}: expected a positive number, got {getattr(self, name)}")
        if self.contacts not in get_args(Contacts):
            raise ValueError(f"contacts: expected one of {get_args(Contacts)}, got {self.contacts!r}")
        for name in ("width", "height"):
            if getattr(self, name) < 4.0 * self.radius:
                raise ValueError(
                    f"{name}: expected at least 4 * radius = {4.0 * self.radius} m, so that a robot fits beside another"
                    f" both ways round, got {getattr(self, name)} m"
                )
        room = DENSEST_PACKING * self.width * self.height / (pi * self.radius**2)
        if self.robots > room:
            raise ValueError(
                f"robots: at most {int(room)} discs of radius {self.radius} m fit on"
                f" {self.width} m x {self.height} m, got {self.robots}"
            )

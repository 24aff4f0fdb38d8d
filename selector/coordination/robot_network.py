"""The network of a robot as its document declares it: the root, and the networks inside behaviours.

The cleaning robot's document is `configs/robots/cleaning.yaml`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from selector.coordination.robot_vocabulary import InnerNetworkSpec
from selforg.network.nesting import NestedModel


@dataclass(frozen=True)
class RobotNetwork(NestedModel):
    """A network whose inner networks sense and act through components.

    Attributes:
        inner: the networks inside, by behaviour.
        during: goals of coordinators that steer only while certain behaviours run, and these behaviours.
        spec: components of a network inside; None for the root, whose behaviours the host of the robot carries out.

    """

    inner: Mapping[str, RobotNetwork] = field(default_factory=dict)
    during: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    spec: InnerNetworkSpec | None = None

    def all_specs(self) -> Iterator[InnerNetworkSpec]:
        """Yield the documents of all networks inside, at any depth."""
        for held in self.inner.values():
            if held.spec is not None:
                yield held.spec
            yield from held.all_specs()

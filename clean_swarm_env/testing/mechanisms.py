"""The contract of mechanisms: movements, decisions and steering."""

from __future__ import annotations

from typing import Any

import numpy as np

from clean_swarm_env.testing.expecting import expect, expect_registered, expect_same
from selforg.arrays import Ints
from selforg.commands import Commands
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.mechanisms import MECHANISMS, DecisionMechanism, MovementMechanism, SteeringMechanism
from selforg.mechanisms.base import Mechanism
from selforg.parameters import parameters_of
from selforg.plugins import contract
from selforg.randomness import DirectionStream
from selforg.space import Euclidean, Space, Torus

ROWS, NOWHERE, NOW = 6, 2, 1.0
"""Robots of a crowd, the one that has no pose, and the time [s]."""
SPACES = (Torus(11.0, 7.0), Euclidean(2), Euclidean(3))
IN_ORDER = np.arange(ROWS)
CHANNELS = {"sign-1": -1, "sign0": 0, "sign1": 1}
"""Channels of the gradients of a crowd, 15 each, and their attraction."""


def check_mechanism(cls: type[Mechanism], **parameters: Any) -> None:  # noqa: ANN401  (those of the class)
    """Raise PluginError, one line, unless a registered mechanism keeps its contract.

    It answers with finite numbers, alike for the same robots in any order, alone or together, and changes nothing that
    it reads, also where robots and gradients lie upon each other. A movement is zero where there is none; somebody has
    one in a crowd among the gradients of `CHANNELS`. `parameters` come beside those of the class's `example`; a
    function of the buffer returns one.
    """
    expect_registered(cls, MECHANISMS)
    for space in SPACES[: 2 if issubclass(cls, SteeringMechanism) else 3]:
        made = crowded(cls, space, parameters)
        before = _kept(made.buffer)
        first = answers(made, IN_ORDER)
        expect_same(_kept(made.buffer), before, cls, "", "to change nothing in the world by asking")
        expect_same(answers(crowded(cls, space, parameters), IN_ORDER), first, cls, "", "the same for the same seed")
        some = answers(crowded(cls, space, parameters), np.array([4, 1]))
        expect_same(some, [one[[4, 1]] for one in first], cls, "", "for some of the rows what all of them get")
        order = np.array([3, 0, 5, 1, 4, 2])
        pairs = zip(first, answers(crowded(cls, space, parameters, order), IN_ORDER), strict=True)
        same = all(np.allclose(one[order], other, rtol=0.0, atol=1e-12) for one, other in pairs)  # sums in other orders
        expect(same, cls, "", "rows in another order to get the same in that order, got others")
        if isinstance(made, MovementMechanism):
            vectors, active = made.move(NOW)
            expect(active.any(), cls, "", f"a movement of somebody in a crowd with the channels {', '.join(CHANNELS)}")
            expect(not (vectors[~active].any() or active[NOWHERE]), cls, "", "no vector without a movement or a pose")
        answers(crowded(cls, space, parameters, side=0.0), IN_ORDER)


def answers(made: Mechanism, rows: Ints) -> tuple[Any, ...]:
    """Return what a mechanism says of `rows` (K,), with K as the first axis; PluginError unless it is finite."""
    found: tuple[Any, ...] = ()
    with contract(made, "", rows):
        if isinstance(made, MovementMechanism):
            found = made.move(NOW, rows)
        elif isinstance(made, DecisionMechanism):
            decision = made.decide(NOW, rows)
            found = decision.values, decision.states, decision.decided
        elif isinstance(made, SteeringMechanism):
            commands, others = Commands(ROWS, 2), np.setdiff1d(IN_ORDER, rows)
            commands.vectors[:], commands.commanded[:] = made.poses.own[:, 0, 6:8], True
            made.steer(NOW, rows, commands.packed.handle)
            kept = [made.poses.own[others, 0, 6:8]]
            expect_same([commands.vectors[others]], kept, made, "steer", "to change no other rows")
            found = commands.vectors[rows], commands.commanded[rows], commands.in_place[rows]
    expect(all(np.isfinite(one).all() for one in found), made, "", "finite numbers, got NaN or infinity")
    return found


def crowded(
    cls: type[Mechanism], space: Space, parameters: dict[str, Any], order: Ints = IN_ORDER, side: float = 5.0
) -> Mechanism:
    """Return a mechanism of robots, in some order, among gradients of each kind on a square of a side [m].

    All lie at one place, and gradients have no end, where the side is 0.
    """
    rng, poses = np.random.default_rng(1), OwnPoses(space, ROWS)
    buffer = SoBuffer(BufferSettings(aggregation_distance=0.0), space, poses)
    places, headings = 1.0 + rng.random((ROWS, space.dim)) * side, rng.uniform(-3.0, 3.0, ROWS)
    for now in (0.0, 0.5):  # two poses, so that everybody has a velocity
        poses.update((places + 0.04 * side * now)[order], headings[order], now)
    poses.forget(np.flatnonzero(order == NOWHERE))
    for channel, sign in CHANNELS.items():
        around = 1.0 + rng.random((15, space.dim)) * side
        reach = np.full(15, 2.0 if side else np.inf)
        buffer.store_static(0, channel, around, 0.0, attraction=sign, diffusion=reach, goal_radius=0.2)
    generators = [np.random.default_rng((9, row)) for row in order.tolist()]
    drawn: dict[str, Any] = {"generators": generators, "directions": DirectionStream(generators, space.dim)}
    given = {name: one for name, one in drawn.items() if name in parameters_of(cls)} | dict(cls.example) | parameters
    with contract(cls, "__init__"):
        return cls(buffer, **{name: one(buffer) if callable(one) else one for name, one in given.items()})


def _kept(buffer: SoBuffer) -> list[Any]:
    return [buffer.table.record.near[: len(buffer)].copy(), buffer.poses.own.copy(), buffer.poses.positions.copy()]

"""The cleaning robot's behaviour network: its sensors, behaviours and goals (the paper's Fig. 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config import NetworkConfig
from clean_swarm_env.garbage import NOTHING, distance, nearest_lying
from selector.coordinator import CoordinatorModel
from selforg.compiled import kernel
from selforg.network.activators import Boolean, Linear
from selforg.network.behaviours import Behaviour, Effect, Goal, NetworkSettings, Sensor, Weights
from selforg.network.conditions import Condition, Negation
from selforg.network.model import NetworkModel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

GOAL = "AvoidCollision"

SENSORS = (
    Sensor("garbage_seen", "fact"),
    Sensor("garbage_at", "fact"),
    Sensor("garbage_found", "fact"),
    Sensor("carrying", "fact"),
    Sensor("recycled", "fact"),
    Sensor("at_recycling", "fact"),
    Sensor("at_dump", "fact"),
    Sensor("dist_recycling", "number"),
    Sensor("dist_dump", "number"),
    Sensor("patrolled", "fact"),  # never true: patrolling has no end
)
(
    GARBAGE_SEEN,
    GARBAGE_AT,
    GARBAGE_FOUND,
    CARRYING,
    RECYCLED,
    AT_RECYCLING,
    AT_DUMP,
    DIST_RECYCLING,
    DIST_DUMP,
) = range(9)  # columns of the readings; the coordinator's sensors come after SENSORS


def robot_model(config: NetworkConfig, avoidance: CoordinatorModel) -> NetworkModel:
    """Return the model of a cleaning robot whose collision avoidance is coordinated."""
    return NetworkModel(
        (*SENSORS, *avoidance.sensors),
        (*_task_behaviours(config), avoidance.behaviour()),
        (
            Goal("PatrolEnvironment", (_is("patrolled"),)),
            Goal("GarbageCleaned", (_is_not("garbage_found"),)),
            Goal(GOAL, (Negation(_is("rep_bool")),)),
        ),
        network_settings(config),
    )


def network_settings(config: NetworkConfig) -> NetworkSettings:
    """Return the settings of the network as `selforg` takes them."""
    return NetworkSettings(
        weights=Weights(**config.weights.model_dump()),
        activation_decay=config.activation_decay,
        activation_threshold=config.activation_threshold,
        threshold_decay=config.threshold_decay,
        max_parallel=config.max_parallel,
    )


def _task_behaviours(config: NetworkConfig) -> tuple[Behaviour, ...]:
    far = Linear(0.0, config.transport_full_range)
    carrying, recycled = _is("carrying"), _is("recycled")
    return (
        Behaviour("Patrol", (_is_not("garbage_found"),), (Effect("patrolled", 1.0), Effect("garbage_seen", 1.0))),
        Behaviour(
            "MoveToGarbage",
            (_is("garbage_seen"), _is_not("garbage_at"), _is_not("carrying")),
            (Effect("garbage_at", 1.0),),
        ),
        Behaviour(
            "PickGarbage",
            (_is("garbage_at"), _is_not("carrying")),
            (Effect("carrying", 1.0), Effect("garbage_at", -1.0)),
        ),
        Behaviour(
            "MoveToRecycling",
            (carrying, _is_not("recycled"), Condition("dist_recycling", far), _is_not("at_recycling")),
            (Effect("dist_recycling", -1.0), Effect("at_recycling", 1.0)),
            ready_threshold=0.05,
        ),
        Behaviour("Recycle", (carrying, _is_not("recycled"), _is("at_recycling")), (Effect("recycled", 1.0),)),
        Behaviour(
            "MoveToDump",
            (carrying, recycled, Condition("dist_dump", far), _is_not("at_dump")),
            (Effect("dist_dump", -1.0), Effect("at_dump", 1.0)),
            ready_threshold=0.05,
        ),
        Behaviour(
            "Dump",
            (carrying, recycled, _is("at_dump")),
            (Effect("carrying", -1.0), Effect("recycled", -1.0), Effect("garbage_found", -1.0)),
        ),
    )


def _is(fact: str) -> Condition:
    return Condition(fact, Boolean(True))


def _is_not(fact: str) -> Condition:
    return Condition(fact, Boolean(False))


@kernel
def read_sensors(
    robots: Floats, extent: Floats, stations: Floats, limits: Floats,
    positions: Floats, stage: Ints, cargo: Ints, recycled: Ints, readings: Floats,
) -> None:  # fmt: skip
    """Write the robot's own sensors into `readings` (R, S).

    robots (R, 2) and extent (2,) [m]; stations (2, 2): recycling and dump [m]; limits (3,): distances of seeing an
    item, of being at an item, of being at a station [m]; positions, stage, cargo, recycled: of `Garbage`.
    """
    per_world = robots.shape[0] // positions.shape[0]
    for row in range(robots.shape[0]):
        x, y = robots[row, 0], robots[row, 1]
        world = row // per_world
        _, near = nearest_lying(x, y, positions[world], stage[world], extent)
        carrying = cargo[row] != NOTHING
        to_recycling = distance(x, y, stations[0, 0], stations[0, 1], extent)
        to_dump = distance(x, y, stations[1, 0], stations[1, 1], extent)
        readings[row, GARBAGE_SEEN] = 1.0 if near <= limits[0] else 0.0
        readings[row, GARBAGE_AT] = 1.0 if near <= limits[1] else 0.0
        readings[row, GARBAGE_FOUND] = 1.0 if near <= limits[0] or carrying else 0.0
        readings[row, CARRYING] = 1.0 if carrying else 0.0
        readings[row, RECYCLED] = 1.0 if recycled[row] else 0.0
        readings[row, AT_RECYCLING] = 1.0 if to_recycling <= limits[2] else 0.0
        readings[row, AT_DUMP] = 1.0 if to_dump <= limits[2] else 0.0
        readings[row, DIST_RECYCLING] = to_recycling
        readings[row, DIST_DUMP] = to_dump

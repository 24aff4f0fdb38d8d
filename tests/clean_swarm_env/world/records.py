"""Records of a tick made by hand, for tests of single stages."""

import numpy as np

from clean_swarm_env.tasks.cleaning.records import FloorRecord, MindsRecord
from clean_swarm_env.tasks.cleaning.robot import OWN_SENSORS
from selforg.network.state import MARK_LAYERS


def floor_record(garbage, robots, extent, **fields):
    """Return the record of a floor with items and robots at places (R, 2) [m]; what is not given is 0."""
    worlds, items, rows = *garbage.stage.shape, len(robots)
    blank = {
        "stations": np.zeros((worlds, 2, 2)), "kinds": np.arange(2),
        "standing": np.zeros(rows, np.int64), "nearest": np.zeros(rows, np.int64),
        "picked": np.zeros((rows, 2), np.int64), "at_item": 0.0, "at_station": 0.0, "pick_distance": 0.0,
        "room": np.ones(rows, np.int64), "finders": 0, "walled": 0, "hidden": 0, "found_again": 1,
        "headings": np.zeros(rows), "longest": 1.0, "phases": np.zeros(rows, np.int64),
        "in_sight": np.zeros(rows, np.int64), "station_ways": np.zeros((rows, 2, 3)), "nearness": np.zeros((rows, 2)),
        "lying": np.zeros(items, np.bool_), "cells": np.empty((0, 0), np.int64), "links": np.empty(items, np.int64),
    }  # fmt: skip
    names = ("stage", "leftover", "under", "found", "cargo", "recycled", "leg", "blind", "done")
    lying = {name: getattr(garbage, name) for name in names}
    fields["sight"] = np.full(rows, fields.get("sight", 0.0))
    return FloorRecord(robots=robots, extent=extent, items=garbage.positions, **lying, **blank | fields)


def minds_record(rows, behaviours=1, handling=(0, 0, 0)):
    """Return the record of robots that read 0 everywhere and do nothing; `handling` (3,) behaviours handle cargo."""
    return MindsRecord(
        readings=np.zeros((rows, len(OWN_SENSORS))),
        marks=np.zeros((rows, MARK_LAYERS, behaviours), np.int64),
        handling=np.array(handling, np.int64),
        transport=np.zeros(2, np.int64),
        movers=np.zeros(1, np.int64),
        starting=np.zeros((rows, 3), np.bool_),
        running=np.zeros((1, rows), np.int64),
        counts=np.zeros(1, np.int64),
    )

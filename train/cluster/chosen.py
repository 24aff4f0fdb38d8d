"""The engine that a command asks for."""

from train.cluster.bits import WorkerBits
from train.cluster.dask_engine import DaskEngine
from train.running.engine import Engine
from train.running.needs import Machine
from train.running.processes import Processes


def chosen_engine(machine: Machine, bits: WorkerBits) -> Engine:
    """Return the engine of this machine, or of the place that it names; see `DaskEngine`."""
    return Processes(machine.workers) if machine.place is None else DaskEngine(machine.place, bits)

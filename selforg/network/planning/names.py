"""A planner by name, as settings give it: the built-in search, none, or an engine of the unified-planning library."""

from __future__ import annotations

from functools import partial

from selforg.network.model.model import NetworkModel
from selforg.network.planning.engines.engine import EngineSearch, check_engine
from selforg.network.planning.planner import BuiltInPlanner, Planner

BUILT_IN, OFF = "built-in", "off"


def check_planner(name: str) -> None:
    """Refuse a name that `planner_named` would not know.

    Raises:
        ValueError: neither "built-in" nor "off", and no engine of that name is installed; lists what there is.
        ModuleNotFoundError: an engine is asked for, and the extra `planning` is not installed; says how to get it.

    """
    if name in (BUILT_IN, OFF):
        return
    try:
        check_engine(name)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(f"planner {name!r} is neither {BUILT_IN!r} nor {OFF!r}, and {error}") from error


def planner_named(model: NetworkModel, name: str) -> Planner | None:
    """Return the planner `name` for `model`: "built-in", "off" (none), or an engine such as "aries".

    Plans of an engine are remembered like those of the built-in search, so that the engine is asked seldom. An engine
    need not give the cheapest plan, nor the same one on every machine. A late answer counts as no plan.

    Raises:
        ValueError, ModuleNotFoundError: as `check_planner`.

    """
    check_planner(name)
    if name == OFF:
        return None
    return BuiltInPlanner(model) if name == BUILT_IN else BuiltInPlanner(model, partial(EngineSearch, engine=name))

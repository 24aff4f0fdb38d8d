"""The best plan within a limit of steps, by the engine Aries (MIT) of the unified-planning library.

Aries proves optimality and unsolvability only for hierarchical problems; a chain of tasks, each "one action and the
next task, or stop", is one, and holds exactly the plans up to its length.
"""

from unified_planning.model.htn import HierarchicalProblem, Method

from selforg.network.planning.pddl import environment, to_unified


def best_plan(search, facts, numbers, goals, horizon):
    """Return the action indices of a cheapest plan of at most `horizon` steps, None if there is none."""
    factory = environment().factory
    if "aries-opt" not in factory.engines:
        factory.add_engine("aries-opt", "up_aries", "AriesOpt")
    task = chain(to_unified(search, search.read_state(facts, numbers), goals), horizon)
    with factory.OneshotPlanner(name="aries-opt") as planner:
        assert planner.supports(task.kind), task.kind
        result = planner.solve(task, timeout=30)
    if result.plan is None:
        assert result.status.name.startswith("UNSOLVABLE"), result
        return None
    assert result.status.name == "SOLVED_OPTIMALLY", result
    indices = {action.name: index for index, action in enumerate(search.problem.actions)}
    return tuple(indices[step.action.name] for step in result.plan.action_plan.actions)


def chain(flat, horizon):
    """Return the hierarchical problem of all plans of `flat` with at most `horizon` steps."""
    target = HierarchicalProblem("chain", environment())
    for fluent in flat.fluents:
        target.add_fluent(fluent, default_initial_value=flat.initial_value(fluent))
    target.add_actions(flat.actions)
    for goal in flat.goals:
        target.add_goal(goal)
    target.add_quality_metric(flat.quality_metrics[0])
    slots = [target.add_task(f"slot_{position}") for position in range(horizon + 1)]
    for position, slot in enumerate(slots):
        add_method(target, f"stop_{position}", slot, [])
        for action in flat.actions if position < horizon else ():
            add_method(target, f"{action.name}_{position}", slot, [action, slots[position + 1]])
    target.task_network.add_subtask(slots[0])
    return target


def add_method(target, name, task, parts):
    method = Method(name, _env=environment())
    method.set_task(task)
    added = [method.add_subtask(part) for part in parts]
    if len(added) > 1:
        method.set_ordered(*added)
    target.add_method(method)

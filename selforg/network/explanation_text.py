"""An explanation as plain text: a table of the behaviours and a tree of their conditions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from selforg.network.explanation import BehaviourAccount, ConditionAccount, Explanation, GoalAccount

TERM_TITLES = {
    "preconditions": "situation",
    "goals": "goals",
    "goal_inhibition": "inhibition",
    "predecessors": "predecessors",
    "successors": "successors",
    "conflictors": "conflictors",
    "plan": "plan",
}


def text_of(explanation: Explanation) -> str:
    """Return the whole explanation."""
    return "\n".join([*header(explanation), "", *table(explanation.behaviours), "", *condition_tree(explanation)])


def header(explanation: Explanation) -> Iterator[str]:
    """Yield threshold and plan; the step that is due stands in brackets."""
    yield (
        f"threshold {explanation.threshold:.4g} (this step decided by {explanation.deciding:.4g}), "
        f"total activation before {explanation.total:.4g}"
    )
    if explanation.plan is None:
        yield "no plan"
        return
    steps = [f"[{name}]" if k == explanation.plan_index else name for k, name in enumerate(explanation.plan)]
    yield f"plan: {' > '.join(steps) or 'nothing to do'}"


def table(behaviours: Sequence[BehaviourAccount]) -> list[str]:
    """Return a line for each behaviour in falling activation; * marks what runs."""
    head = ["", "behaviour", "activation", *TERM_TITLES.values(), "satisfied", "why"]
    rows = [head, *(_cells(account) for account in behaviours)]
    widths = [max(len(row[k]) for row in rows) for k in range(len(head))]
    return ["  ".join(_aligned(row, widths)).rstrip() for row in rows]


def condition_tree(explanation: Explanation) -> Iterator[str]:
    """Yield behaviours and goals with their wishes and conditions; * marks what runs."""
    for account in explanation.behaviours:
        mark, ready = "* " if account.running else "", "ready" if account.ready else "not ready"
        yield f"{mark}{account.name}: {account.why} ({ready}, satisfied {account.satisfaction:.3g}{_wishes(account)})"
        yield from _branches(account.conditions, "")
    for goal in explanation.goals:
        off = "" if goal.enabled else " (off)"
        yield f"goal {goal.name}{off}: satisfied {goal.satisfaction:.3g}{_wishes(goal)}"
        yield from _branches(goal.conditions, "")


def _cells(account: BehaviourAccount) -> list[str]:
    terms = [f"{account.components[name]:.3f}" for name in TERM_TITLES]
    mark = "*" if account.running else ""
    return [mark, account.name, f"{account.activation:.3f}", *terms, f"{account.satisfaction:.2f}", account.why]


def _aligned(row: list[str], widths: list[int]) -> list[str]:
    """Pad cells to a width: names and reasons to the left, numbers to the right."""
    left = (0, 1, len(row) - 1)
    return [text.ljust(w) if k in left else text.rjust(w) for k, (text, w) in enumerate(zip(row, widths, strict=True))]


def _wishes(account: BehaviourAccount | GoalAccount) -> str:
    wished = [f"{sensor} {wish:+.3g}" for sensor, wish in account.wishes if wish != 0.0]
    return f", wishes {', '.join(wished)}" if wished else ""


def _branches(accounts: Sequence[ConditionAccount], indent: str) -> Iterator[str]:
    for k, account in enumerate(accounts):
        last = k == len(accounts) - 1
        yield f"{indent}{'└─' if last else '├─'} {account.label}: {account.satisfaction:.3g}"
        yield from _branches(account.parts, indent + ("   " if last else "│  "))

"""The search for the best options of a mission: in each round arms do the same fresh starts, and the worse half goes.

An arm is a strategy that robots follow: a combination of options, a rule, or a policy. A round makes no claim and has
no test: the ranks of its mean excess say who stays, with twice as many starts for the next one (Karnin et al. 2013,
Almost optimal exploration in multi-armed bandits). First each goal races alone, then the best of each together, then
variants of the numbers of the best, then rules and policies. There the experts' choice and never avoiding stay.

What is done next follows from the runs that are done: a search that goes on comes to the same end, in any number of
processes.

Shapes: A arms, n starts of a round.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from scipy.stats import rankdata

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.deciders.named import FIXED
from selector.documents.fields import JOINT
from selector.knowledge import ENOUGH, Option
from selforg.arrays import Flags
from train.advising.opening import OpenedMission
from train.advising.rounds import Round, filled_up, needed, portfolio
from train.running.runs import RunKey, RunRecord

LOOK_STARTS = 8
"""Starts of the first look, which tells how long missions take."""
CHECK_STARTS = 3
"""Starts on which scores that are known already are checked."""
TRUSTED = 0.5
"""Rank correlation of known scores and this check from which on the scores are trusted [-]."""
NEVER = "Off"
"""The option that never avoids."""
FINALISTS = 3
"""Arms with which a race ends."""
JAMMED = 10
"""Starts after which an arm stops that left half of them unfinished, if another one did not."""
BUDGET_SHARES = {"goals": 0.35, "together": 0.15, "numbers": 0.12, "duel": 0.06, "choosers": 0.06}
"""Part of the budget for each part of the search; the last round gets the rest."""
FEWEST_STARTS, MOST_STARTS = 2, 32
"""Bounds of the starts of a round."""
LAST_FEWEST, LAST_MOST = 20, 400
"""Bounds of the starts of the last round."""


@dataclass(frozen=True)
class SearchResult:
    """What a search found."""

    winner: str
    """The arm of the lowest excess."""
    leader: str
    """The best arm before its numbers were varied."""
    finalists: tuple[str, ...]
    """The winner, and the arms that would best be chosen from beside it, start by start."""
    choosers: tuple[str, ...]
    """The best rule and the best policy, where some fit."""
    variants: int
    """Number of variants that were tried."""
    starts: int
    """Starts of the last round."""
    kinds: Mapping[str, str]
    """Kind of start -> the arm of the lowest excess on those of the kind."""


@dataclass
class AdviceSearch:
    """A search over the arms of an opened mission.

    Raises Lacking where it needs missions that are not done.
    """

    opened: OpenedMission
    choosers: Sequence[str]
    """Rules and policies that fit."""
    varied: Callable[[Mapping[str, str]], Mapping[str, Sequence[Option]]]
    """Returns the variants of options; goal -> option."""
    done: Mapping[RunKey, RunRecord]
    budget: float
    """What all missions may take: time of processors [s], or their number."""
    price: Callable[[RunRecord], float]
    """Returns what a mission took of it."""
    reward: Callable[[RunRecord], float]
    counts: bool
    """Whether unfinished missions mean something."""
    entrants: Callable[[str, Sequence[str], Sequence[str]], int]
    """Returns the number of missions of each start in the last round."""
    kind: Callable[[str], str] = lambda name: ""
    """Returns the kind of a scenario; one kind has none that is best for it alone."""
    rounds: list[Round] = field(default_factory=list)
    stopped: dict[str, int] = field(default_factory=dict)
    """Arm that was stopped -> starts that it did not finish."""
    left_out: set[str] = field(default_factory=set)
    """Options that were not tried for lack of time."""
    _next: int = 0
    _spent: float = 0.0
    _missions: int = 0

    def run(self) -> SearchResult:
        """Return what the search finds."""
        held = dict(self.opened.experts)
        look = self._round("first look", [arm_of(held)], LOOK_STARTS)
        if self.opened.combinations == 1:
            return SearchResult(look.arms[0], look.arms[0], look.arms, (), 0, LAST_FEWEST, {})
        best = self._goals_alone(held)
        arms = [arm_of(held | dict(zip(best, names, strict=True))) for names in product(*best.values())]
        kept = list(dict.fromkeys((arm_of(self.opened.experts), *never_avoiding(self.opened, held))))
        if len(best) > 1:
            every = list(dict.fromkeys((*arms, *kept)))
            count = self._starts(BUDGET_SHARES["together"], 2 * len(every))
            arms = self._race("together", every, count, kept)
        joint = next((one for one in self.rounds if one.title == "together"), self.rounds[-1])
        leader, variants = arms[0], 0
        held = held_by(self.opened, leader)
        if more := [arm_of({**held, goal: one.name}) for goal, own in self.varied(held).items() for one in own]:
            count = self._starts(BUDGET_SHARES["numbers"], 2 * len(more))
            own = self.rounds[-1].best_of_kinds.values()
            arms = self._race("numbers", list(dict.fromkeys((*arms[:2], *own, *more, *kept))), count, kept)
            variants = len(more)
        kinds = self.rounds[-1].best_of_kinds
        winner, leader = self._duel(arms[0], leader)
        arms = [winner, *(arm for arm in arms if arm != winner)]
        choosers = self._choosers()
        finalists = (arms[0], *(arm for arm in portfolio(joint, arms[0]) if arm != arms[0]))[:FINALISTS]
        finalists = tuple(dict.fromkeys((*finalists, *kinds.values())))
        each = self._price * self.entrants(arms[0], finalists, choosers)
        starts = int(np.clip((self.budget - self._spent) / each, LAST_FEWEST, LAST_MOST))
        return SearchResult(arms[0], leader, finalists, choosers, variants, starts, kinds)

    def _duel(self, winner: str, leader: str) -> tuple[str, str]:
        """Return the winner and the leader, or what is held in their place unless they are clearly cheaper.

        Of many arms that are as good, one was cheaper by luck; so the winner meets the leader, whose numbers it varies,
        and the experts' choice again.
        """
        experts = arm_of(self.opened.experts)
        if len(arms := list(dict.fromkeys((winner, leader, experts)))) > 1:
            self._round("duel", arms, self._starts(BUDGET_SHARES["duel"], len(arms)))
            winner = winner if self._cheaper(winner, leader) else leader
            if winner != experts and not self._cheaper(winner, experts):
                winner = leader = experts
        return winner, leader

    def _cheaper(self, arm: str, other: str) -> bool:
        """Return whether an arm cost less by twice the error of the mean, on all starts that both did."""
        both = [one for one in self.rounds if {arm, other} <= {*one.arms}]
        costs = np.concatenate([one.costs[[one.arms.index(arm), one.arms.index(other)]] for one in both], axis=1)
        saved = costs[1] - costs[0]
        return bool(saved.mean() > 2.0 * saved.std() / np.sqrt(len(saved)))

    @property
    def leads(self) -> str:
        """Who led in the last round, in words."""
        last = self.rounds[-1]
        return (
            f"in the search {last.order[0].removeprefix(f'{FIXED}:')} leads at {last.means.min():,.0f} s ({last.title})"
        )

    @property
    def _price(self) -> float:
        """What a mission took on average so far."""
        return max(self._spent, 1e-6) / self._missions

    def _starts(self, part: float, arms: int) -> int:
        """Return how many starts a race begins with that may take a `part` of the budget; `arms`: of all its rounds."""
        return int(np.clip(part * self.budget / (self._price * max(arms, 1)), FEWEST_STARTS, MOST_STARTS))

    def _goals_alone(self, held: dict[str, str]) -> dict[str, list[str]]:
        """Race the options of each goal, with what won before for the others; return the best few of each goal.

        Avoidance comes first, since others tell nothing where robots jam. A goal whose partners were others in its race
        does it again: beside bad partners the best may be the last. Of three goals or more two are left of each, or
        else too many combinations would have to race.
        """
        first = sorted(self.opened.goals, key=lambda goal: goal != AVOIDANCE)
        options = {goal: self.opened.names(goal) for goal in first}
        rounds = {goal: len(own) * max(np.ceil(np.log2(len(own) / FINALISTS)), 1.0) for goal, own in options.items()}
        order = [*options, *list(options)[:-1]]
        best: dict[str, list[str]] = {}
        partners_of: dict[str, dict[str, str]] = {}
        for goal in order:
            partners = {other: name for other, name in held.items() if other != goal}
            if partners_of.get(goal) == partners:
                continue
            part = BUDGET_SHARES["goals"] * rounds[goal] / sum(rounds[each] for each in order)
            tried = self._tried(goal, held, part * self.budget / (self._price * rounds[goal] * FEWEST_STARTS))
            arms = {arm_of({**held, goal: name}): name for name in tried}
            count = self._starts(part, int(rounds[goal]))
            found = self._race(goal, list(arms), count) if len(arms) > 1 else list(arms)
            kept = (*found[: FINALISTS if len(options) < 3 else FINALISTS - 1], *self.rounds[-1].best_of_kinds.values())
            best[goal] = list(dict.fromkeys(arms[arm] for arm in kept if arm in arms))
            partners_of[goal], held[goal] = partners, best[goal][0]
        return best

    def _tried(self, goal: str, held: Mapping[str, str], able: float) -> list[str]:
        """Return the options of a goal that race; `able` is the share of them for which there is time."""
        tried = self._trusted(goal, self.opened.names(goal), held)
        if able >= 1.0:
            return tried
        first, scores = (held[goal], NEVER), self.opened.elsewhere
        order = sorted(tried, key=lambda name: (name not in first, -scores.get(name, 0.0)))
        kept = order[: max(int(len(self.opened.names(goal)) * able), FINALISTS)]
        self.left_out |= set(tried) - set(kept)
        return kept

    def _trusted(self, goal: str, names: list[str], held: Mapping[str, str]) -> list[str]:
        """Return the best third of options whose scores are known from missions, if a check agrees; else all."""
        count, mean = self.opened.known.rewards(goal)[:2]
        if len(names) <= FINALISTS or count.min() < ENOUGH:
            return names
        checked = self._round(f"{goal}, check", [arm_of({**held, goal: name}) for name in names], CHECK_STARTS)
        agree = np.corrcoef(rankdata(-mean), rankdata(checked.means))[0, 1]
        if not agree >= TRUSTED:
            return names
        kept = {names[place] for place in (-mean).argsort(kind="stable")[: max(len(names) // 3, FINALISTS)]}
        return [name for name in names if name in kept or name == held[goal]]

    def _race(self, title: str, arms: Sequence[str], count: int, kept: Sequence[str] = ()) -> list[str]:
        """Return the arms that are left in the end, the cheapest first; those that are `kept` never drop out."""
        while True:
            done = self._round(title, arms, count)
            if len(arms) <= max(FINALISTS, len(kept) + 1):
                return done.order
            half = [*done.order[: max(len(arms) // 2, FINALISTS)], *portfolio(done, done.order[0])[:2]]
            half += [*done.best_of_kinds.values(), *(arm for arm in arms if arm in kept)]
            if len(half := list(dict.fromkeys(half))) == len(arms):
                return done.order
            arms, count = half, min(2 * count, MOST_STARTS)

    def _choosers(self) -> tuple[str, ...]:
        """Return the best rule and the best policy of those that fit."""
        kinds = dict.fromkeys(name.partition(":")[0] for name in self.choosers)
        if len(kinds) == len(self.choosers):
            return tuple(self.choosers)
        starts = self._starts(BUDGET_SHARES["choosers"], len(self.choosers))
        order = self._round("choosers", self.choosers, starts).order
        return tuple(next(name for name in order if name.partition(":")[0] == kind) for kind in kinds)

    def _round(self, title: str, arms: Sequence[str], count: int) -> Round:
        """Return what arms bring on the next fresh starts; those that jam stop after some of them."""
        numbers = range(self._next, self._next + count)
        found = self._runs(arms, numbers[:JAMMED])
        going: Flags = np.ones(len(arms), dtype=np.bool_)
        if self.counts and count >= JAMMED:
            lost = np.array([sum(not record.result.completed for record in found[arm]) for arm in arms])
            going = (2 * lost < JAMMED) if (2 * lost < JAMMED).any() else going
            self.stopped |= {arm: int(many) for arm, goes, many in zip(arms, going, lost, strict=True) if not goes}
        further = self._runs([arm for arm, goes in zip(arms, going, strict=True) if goes], numbers[JAMMED:])
        self._next += count
        runs = [[*found[arm], *further.get(arm, ())] for arm in arms]
        self._spent += sum(self.price(record) for own in runs for record in own)
        self._missions += sum(map(len, runs))
        costs, rewards = (
            np.array([filled_up([value(record) for record in own], count) for own in runs])
            for value in (lambda record: record.result.excess_s, self.reward)
        )
        kinds = tuple(self.kind(scenario_name("train", number)) for number in numbers)
        self.rounds.append(Round(title, tuple(arms), costs, rewards, kinds))
        return self.rounds[-1]

    def _runs(self, arms: Sequence[str], numbers: range) -> dict[str, list[RunRecord]]:
        """Return arm -> the runs on starts; Lacking if some are not done."""
        keys = {arm: [(scenario_name("train", number), arm) for number in numbers] for arm in arms}
        return needed(keys, self.done)


def arm_of(held: Mapping[str, str]) -> str:
    """Return the arm that holds options; goal -> option."""
    return f"{FIXED}:{JOINT.join(held.values())}"


def held_by(opened: OpenedMission, arm: str) -> dict[str, str]:
    """Return goal -> the option that an arm of fixed options holds."""
    return dict(zip(opened.goals, arm.partition(":")[2].split(JOINT), strict=True))


def never_avoiding(opened: OpenedMission, held: Mapping[str, str]) -> list[str]:
    """Return the arm that never avoids beside the other options of `held`; none where no goal has such an option."""
    return [arm_of({**held, goal: NEVER}) for goal in opened.goals if NEVER in opened.names(goal)]

"""Advice in words: what to hold, what that saves beside what one would do else, and whether to change it on the way."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.deciders.named import FIXED, MACHINE, decider_named
from clean_swarm_env.deciders.unseen import untrained
from clean_swarm_env.world.task import task_class
from selector.documents.fields import JOINT
from train.advising import perturbed
from train.advising.findings import Findings
from train.advising.rounds import broke_off
from train.advising.search import BUDGET_SHARES, JAMMED, LAST_MOST, arm_of, never_avoiding
from train.analysis.family_report import FamilyReport
from train.analysis.intervals import TOLD, Estimate, Ratio, about_number
from train.analysis.verdict import RANDOM, amount, interval_words, listed, most_left, ratio_words
from train.reports.family_tables import family_tables
from train.reports.figures import draw_family
from train.reports.text_table import EMPTY_CELL, Grid, Publication

TWICE = 2.0
"""Times the starts that are asked for at least where they have told nothing."""
NONE_FITS = "No rule or policy that ships fits this mission."
OVER = 1.5
"""Times the time that was given, from which on the advice says how long it took."""


class Advice(Findings):
    """What was found for a mission, in words."""

    @property
    def sentences(self) -> list[str]:
        """The advice in a few sentences."""
        evaluation = self.evaluation
        if evaluation.nothing_to_choose:
            return [f"{evaluation.family.name}: there is nothing to choose: {self._words(self.found.winner)} is all."]
        lost = self.runs.unfinished[self.found.winner].sum() if self.runs.unfinished else 0
        if 2 * lost >= self.found.starts:
            limit = max(mission.time_limit for mission in self.runs.missions)
            short = f"the time limit of {limit:g} s may be too short."
            hopeless = f"So nothing that was tried does this mission, and no selector is judged: {short}"
            return [self._hold, *self._remarks, hopeless]
        parts = (self._hold, self._beside, self._on_the_way, self._of_kinds, self._perturbed, self._worth)
        return [*filter(None, (*parts, *self._remarks))]

    @property
    def _way(self) -> str:
        """What is held, in a word."""
        return {1: "option", 2: "pair"}.get(len(self.held), "combination")

    @cached_property
    def broken(self) -> dict[str, str]:
        """Arm of which a plug-in broke missions off -> why."""
        return {one.condition: why for one in self.search.done.values() if (why := broke_off(one))}

    def _ended(self, arm: str) -> str:
        """Return how an arm ended that was stopped in the last round."""
        many = f"{self.stopped[arm]} of {min(self.found.starts, JAMMED)}"
        return f"had {many} broken off by a plug-in" if arm in self.broken else f"left {many} unfinished"

    @property
    def _hold(self) -> str:
        evaluation, found, opened = self.evaluation, self.found, self.evaluation.opened
        mean = Estimate.of(self.costs[found.winner].mean(axis=2))
        tried = [len(set(opened.names(goal)) - self.search.left_out) for goal in opened.goals]
        of = f"{int(np.prod(tried))} {self._way}s"
        variants = f" and {found.variants} variants of their numbers" if found.variants else ""
        given = len(evaluation.family.starts)
        starts = f"missions from its {given} start{'s' * (given > 1)}" if given else "starts"
        each = "an item" if items_keep_coming(evaluation.mission) else "a mission"
        cost = f"{amount(mean.value)} s {each}{interval_words(mean.ci95, amount)} on {found.starts} fresh {starts}"
        begin = (
            f"{evaluation.family.name}: hold {self._words(found.winner)}: it costs {cost}, the least of {of}{variants}."
        )
        if not self.runs.unfinished:
            return begin
        lost, most = int(self.runs.unfinished[found.winner].sum()), most_left(self.runs.unfinished[found.winner])
        word = task_class(evaluation.mission).missed[1]
        many = f"{lost or 'No'} mission{'s' * (lost > 1)} of {found.starts} {'were' if lost > 1 else 'was'} {word}"
        return f"{begin} {many} (up to {most:.0%} may be)."

    @property
    def _beside(self) -> str:
        opened, winner, parts, lost = self.evaluation.opened, self.found.winner, list[str](), list[str]()
        said = dict.fromkeys(never_avoiding(opened, self.held), "never avoiding")
        scores = "the scores before" if opened.known.learned else "the experts' scores"
        said |= {arm_of(opened.experts): f"{scores} ({self._words(arm_of(opened.experts))})", RANDOM: "a random choice"}
        for arm, name in said.items():
            if arm in self.stopped:
                lost.append(f"{name} {self._ended(arm)}")
            elif arm in self.costs and arm != winner:
                costs = "" if parts else "cost " if name.startswith(scores) else "costs "
                parts.append(f"{name} {costs}{times(self.ratio(arm), 'times as much' if not parts else '')}")
        same = f"{scores} choose the same" if arm_of(opened.experts) == winner else ""
        text = "; ".join(filter(None, (", ".join(parts), *lost, same)))
        return f"{text[0].upper()}{text[1:]}." if text else ""

    @property
    def _on_the_way(self) -> str:
        names = {arm: f"the rule {arm[4:]}" if arm.startswith(f"{MACHINE}:") else arm for arm in self.found.choosers}
        ends = {arm: times(self.ratio(arm)) if arm in self.costs else self._ended(arm) for arm in names}
        told, ratio = ", ".join(f"{names[arm]} {end}" for arm, end in ends.items()), self.hindsight
        begin = f"To change the choice during the mission: {told}." if told else NONE_FITS
        if ratio is None or ratio.ratio is None:
            return begin
        return f"{begin} The best {self._way} of each start in hindsight gains {gain(ratio)}."

    @property
    def _of_kinds(self) -> str:
        if self.by_kind is None:
            return ""
        held = "; ".join(
            f"{kind}: {self._words(arm)} ({self.kinds.count(kind)} starts)" for kind, arm in self.best_of_kinds.items()
        )
        saved = gain(self.by_kind) if {*self.best_of_kinds.values()} - {self.found.winner} else "nothing: one is best"
        return f"By kind: {held}. To tell the kind gains {saved}."

    @property
    def _perturbed(self) -> str:
        if (robust := self.robustness) is None:
            return ""
        worlds, holds = len(robust.best), int(robust.holds.sum())
        begin = f"In {worlds} perturbed worlds it costs {times(robust.ratio, 'times as much')} and holds in {holds}"
        failed = [
            f"in world {number} {self._words(best)} costs {own[best]:.2f} of it"
            for number, best, holding, own in self._of_worlds(robust)
            if not holding
        ]
        return f"{'; '.join([begin, *failed])}."

    def _of_worlds(self, robust: perturbed.Robustness) -> list[tuple[int, str, bool, dict[str, float]]]:
        """Return number, best arm, whether the choice holds, and the costs of all arms by those of the choice."""
        held = robust.means[self.found.winner]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = {arm: own / held for arm, own in robust.means.items()}
        shares = [{arm: float(own[place]) for arm, own in ratios.items()} for place in range(len(held))]
        return list(zip(self.evaluation.worlds, robust.best, robust.holds.tolist(), shares, strict=True))

    @property
    def _world_grids(self) -> list[Grid]:
        """The table of the perturbed worlds, if they were asked for."""
        if (robust := self.robustness) is None:
            return []
        seed, arms = self.evaluation.request.seed, list(robust.means)
        rows = []
        for number, _, holding, shares in self._of_worlds(robust):
            drawn = perturbed.drawn_world(seed, number)
            costs = [f"{shares[arm]:.2f}" for arm in arms]
            rows.append([str(number), *(f"{value:g}" for value in drawn.values()), "yes" if holding else "no", *costs])
        heads = ("world", *perturbed.drawn_world(seed, 1), "holds", *arms)
        title = f"perturbed worlds: mean excess of {perturbed.STARTS} starts by that of the choice"
        return [Grid(title, heads, rows)]

    @property
    def _worth(self) -> str:
        learn = "`--learn` trains one for this mission and judges it the same way"
        if self.worth_it is None:
            why = (
                f"{self.unjudged}; --minutes gives more time"
                if self.better or self.gains
                else f"{self._more_starts}. {learn}"
            )
            return f"Whether a selector is worth it here is not known at this budget: {why}."
        if not self.worth_it:
            return f"So a selector is not worth it here: what was tried gains {max(self.most, 0.0):.0%} at most."
        if self.better:
            return f"So a selector is worth it here: {self.better[0]} is shown to be better than the best that is held."
        return f"So a selector may be worth it here, though none that ships is shown to be; {learn}."

    @property
    def _more_starts(self) -> str:
        """The starts that would tell a gain of a tenth and the budget for them, or why there are none."""
        search, starts = self.evaluation, self.found.starts
        counts = [one.tests[0].needed(TOLD) or 0 for one, _ in self.claims.values() if one.tests[0].spread > 0.0]
        if not counts or max(starts + 1, *counts) > LAST_MOST:
            return (
                f"to tell a gain of a tenth takes more than the {LAST_MOST} starts of a last round"
                if counts
                else "there was nothing to compare with what is held"
            )
        count = about_number(min(max([TWICE * starts, *counts]), LAST_MOST))
        last = sum(search.price(run) for run in self.budgeted if run.scenario.startswith("test"))
        budget = count / starts * last / (1.0 - sum(BUDGET_SHARES.values()))
        more = f"--missions {budget:.0f}" if search.missions else f"--minutes {math.ceil(budget / 60.0)}"
        return f"a gain of a tenth would be told on about {count} starts in place of {starts}, with {more}"

    @property
    def _remarks(self) -> list[str]:
        first = {why: arm for arm, why in reversed(self.broken.items())}
        told = [f"{self._words(arm)} dropped out: {why}." for why, arm in first.items()]
        rivals = [arm for arm in self.costs if arm not in (self.found.winner, *self.found.choosers)]
        if cheaper := [arm for arm in rivals if self.costs[arm].mean() < self.costs[self.found.winner].mean()]:
            names = listed([arm.removeprefix(f"{FIXED}:") for arm in cheaper])
            told.append(f"{names} cost less in the last round: the best is not known well; --minutes gives more time.")
        own, budget = self.evaluation.directories, self.evaluation.budget
        for name in self.found.choosers:
            if new := untrained(name, decider_named(name, own), self.runs.missions, own):
                told.append(f"{new}.")
        spent = sum(map(self.evaluation.price, self.budgeted))
        unit, word = (1.0, "missions") if self.evaluation.missions else (60.0, "min of processors")
        untried = f"{len(self.search.left_out)} options for lack of time, " if self.search.left_out else ""
        told.append(f"Not tried: {untried}other numbers of what lost, sums of mechanisms.")
        over = f" It took {amount(spent / unit)}: a race goes on until few are left." if spent > OVER * budget else ""
        told.append(f"Budget: {budget / unit:g} {word}, seed {self.evaluation.request.seed}.{over}")
        return told

    def _words(self, arm: str) -> str:
        """Return what an arm is called in a sentence."""
        return listed(arm.partition(":")[2].split(JOINT)) if arm.startswith(f"{FIXED}:") else arm

    @property
    def publication(self) -> Publication:
        """The report."""
        report, evaluation = FamilyReport.of(self.runs), self.evaluation
        about = f"{evaluation.family.description}\nOptions of {', '.join(evaluation.opened.goals)}."
        ends = {arm: f"{many} of {JAMMED} unfinished" for arm, many in self.search.stopped.items()}
        races = [
            Grid(
                f"search, {done.title}: {done.costs.shape[1]} starts",
                ("strategy", "excess s", "stopped"),
                [
                    (arm, f"{mean:.1f}", ends.get(arm, EMPTY_CELL))
                    for arm, mean in zip(done.order, sorted(done.means.tolist()), strict=True)
                ],
            )
            for done in self.search.rounds
        ]
        grids = [*family_tables(report, self.found.winner), *self._world_grids, *races]
        return Publication(evaluation.family.name, about, self.sentences, grids, self.content, draw_family(report))


def times(ratio: Ratio, words: str = "") -> str:
    """Return a ratio and its interval in words."""
    if ratio.ratio is None:
        return "no ratio"
    return f"{ratio_words(ratio.ratio)}{' ' * bool(words)}{words}{interval_words(ratio.ci95, ratio_words)}"


def gain(ratio: Ratio) -> str:
    """Return what a ratio saves, with its interval, in words."""
    saved = 1.0 - (1.0 if ratio.ratio is None else ratio.ratio)
    ends = None if ratio.ci95 is None else (100.0 - 100.0 * ratio.ci95[1], 100.0 - 100.0 * ratio.ci95[0])
    return f"{'' if saved > 0.0 else 'nothing: '}{saved:z.0%}{interval_words(ends, '{:.0f}'.format)}"

"""The reports of comparisons: tables, figure and verdict of an experiment, of a family, or of its disturbances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from clean_swarm_env.config.load import own_mission
from clean_swarm_env.config.mission import MissionConfig
from train.analysis.family_report import FamilyReport
from train.analysis.report import ExperimentReport, summary_of, verdict_of
from train.analysis.robustness_report import RobustnessReport, durations_over
from train.analysis.runs import Measured, Runs
from train.reports.experiment_tables import all_tables
from train.reports.family_tables import family_tables, robustness_tables
from train.reports.text_table import Publication


def of_experiment(runs: Runs, measured: Measured, starts: str, *, own_starts: bool) -> Publication:
    """Return Table 1, ratios between conditions, comparisons with measured figures, and the figure.

    Args:
        runs: the runs.
        measured: figures that were measured on the same starts.
        starts: where these come from, in words.
        own_starts: whether they are those of the experiment.

    """
    from train.reports.figures import draw_experiment  # waits: the runs need no Matplotlib

    report, document = ExperimentReport(runs, measured, own_starts), runs.document
    about = f"{document.description}\nSeed {runs.seed}; {starts}."
    tables, summary = all_tables(report), summary_of(report)
    return Publication(document.name, about, verdict_of(report), tables, summary, draw_experiment(report))


def of_family(runs: Runs, notes: Sequence[str]) -> Publication:
    """Return how strategies compare with each other; the first table gets further notes."""
    from train.reports.figures import draw_family  # waits: the runs need no Matplotlib

    report, document = FamilyReport.of(runs), runs.document
    first, *others = family_tables(report)
    own, here = setting_of(own_mission(document.mission.task.name)), setting_of(document.mission)
    stated = [f"targets are stated for {own}, not for {here}"] if report.measured and own != here else []
    tables = [replace(first, notes=(*first.notes, *notes, *stated)), *others]
    return Publication(document.name, document.description, report.verdict, tables, report.content, draw_family(report))


def of_disturbances(runs: Runs) -> Publication:
    """Return how strategies compare under disturbances."""
    from train.reports.figures import draw_robustness  # waits: the runs need no Matplotlib

    found, ranking, document = RobustnessReport.of(runs), durations_over(runs), runs.document
    verdict, tables = found.verdict(ranking), robustness_tables(found, ranking)
    return Publication(document.name, document.description, verdict, tables, found.content, draw_robustness(found))


def setting_of(mission: MissionConfig) -> str:
    """Return what users choose of a mission, in words."""
    return f"{mission.robots.count} robots, {mission.time_limit:g} s, {mission.world.ground}"

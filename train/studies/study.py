"""A study from the user's request to knowledge: search, last race, statement, report, export."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.warm_up import compiled_before
from selector.documents.errors import within
from train.deciders.decided_goal import DecidedGoal
from train.evaluation.trial_task import TASK_SCENARIOS
from train.reports.text_table import Publication, publish
from train.request import Request
from train.running.commands import FINISHED, progress
from train.running.engine import WorkerLost, compile_first
from train.running.finished_runs import Results
from train.running.needs import check_needs
from train.running.run_folder import default_directory, fingerprints
from train.studies.conclusion import UNCHANGED, Conclusion, FoundKnowledge, conclude
from train.studies.config import StudyConfig, study_versions
from train.studies.missions import STAGES, Candidate, CandidateTasks, MissionField, TaskMaker
from train.studies.report import importances, study_summary, study_tables, trials_csv, verdict_of
from train.studies.search import Arm, CandidateSearch, StudyTrial
from train.studies.space import StudySpace

MISSIONS = "missions.jsonl"
"""File with the finished missions. A study is a function of its seed and of these: one that was killed starts again,
finds its missions here, and comes to the same trials (docs/decisions/0170-studies-replay.md)."""


def run_study(study: StudyConfig, request: Request, console: Console, make: TaskMaker | None = None) -> int:
    """Do or continue a study, write its results and print its tables; return the exit code.

    Args:
        study: the study.
        request: the request of the user.
        console: shows the tables; the standard error shows the progress.
        make: makes the tasks of candidates; missions of the family unless given.

    """
    directories = tuple(path.resolve() for path in request.directories)
    family, space = _checked(study, request)
    identity = {
        "study": study.model_dump(mode="json"),
        "family": family.model_dump(mode="json"),
        "seed": request.seed,
        "versions": study_versions(),
        "files": fingerprints(directories),
    }
    directory = request.output or default_directory(f"{study.name}-seed{request.seed}", resume=request.resume)
    with request.results(directory, {"identity": identity}) as folder:
        tasks = CandidateTasks(family, request.seed, space.goals[0], folder, directories)
        results = Results(folder, tasks.mistake, journal=MISSIONS)
        try:
            arms, conclusion = _searched(study, request, space, results, make or tasks, family.mission)
            found = FoundKnowledge(study, request.seed, family, space, conclusion)
            folder.write(f"knowledge/{study.name}.yaml", found.text())
            folder.write("trials.csv", trials_csv(arms, space))
            importance = importances(arms, space)
            publication = Publication(
                study.name,
                f"{study.description}\nFamily {family.name}, seed {request.seed}.",
                verdict_of(conclusion),
                study_tables(conclusion, space, importance),
                study_summary(conclusion, space, arms, importance),
            )
            publish(publication, folder, console, request)
            found.give(request.store)
        except (KeyboardInterrupt, WorkerLost) as end:
            return request.ended(end, folder.path, f": {len(results.runs)} missions are kept")
        finally:
            results.close()
    return FINISHED


def _searched(
    study: StudyConfig, request: Request, space: StudySpace, results: Results, make: TaskMaker, mission: MissionConfig
) -> tuple[list[Arm], Conclusion]:
    """Do the missions that are not kept; return what each method found, and the conclusion."""
    unchanged, arms = Candidate(UNCHANGED, space.unchanged()), list[Arm]()
    if not compiled_before():
        compile_first(make(STAGES[0], unchanged, (0,)))
    trials = study.trials * len(study.methods)
    bar = progress(study.method, trials, log=results.folder.path)
    with request.engine.rounds() as done, bar as update:
        update(most=mission.time_limit * trials * study.race.block * study.race.blocks)
        missions = MissionField(make, results, done, mission)
        search = CandidateSearch(study, space, missions, unchanged)
        for method in study.methods:

            def on_batch(trials: Sequence[StudyTrial], method: str = method) -> None:
                told = f"trials, {len(results.runs):,} missions"
                update(description=method, completed=len(trials) + sum(len(arm.trials) for arm in arms), more=told)

            arms.append(search.arm(method, request.seed, on_batch))
        return arms, conclude(study, space, search, arms, missions)


def _checked(study: StudyConfig, request: Request) -> tuple[FamilyConfig, StudySpace]:
    """Return the family and the space; an error of one line for everything that does not exist or fit."""
    directories = request.directories
    with within(f"{study.name}: family"):
        family = load_family(study.family, directories)
    update = {"store": "", **({"knowledge": study.knowledge} if study.knowledge else {})}
    family = family.model_copy(update={"mission": family.mission.model_copy(update=update)})
    with within(study.name):
        space = StudySpace(study, knowledge_of(family.mission, directories), directories)
        for goal in space.goals:
            DecidedGoal(Batch(family.scenario(0, 0, "train").mission, directories=directories), goal)
        most = study.trials * len(study.methods) * study.race.block * study.race.blocks
        check_needs(family.largest, most, request.machine, TASK_SCENARIOS)
    return family, space

"""A study from the user's request to knowledge: search, last race, statement, report, export."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.progress import MofNCompleteColumn

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.warm_up import compiled_before
from selector.documents.errors import within
from train.cluster.bits import noted_bits, noting
from train.deciders.decided_goal import DecidedGoal
from train.evaluation.trial_task import TASK_SCENARIOS
from train.reports.write_report import Publication, publish
from train.request import Request
from train.running.engine import WorkerLost
from train.running.exit_codes import FINISHED
from train.running.needs import Workload, check_needs
from train.running.progress import progress
from train.running.provenance import fingerprints
from train.running.run_folder import COMMAND, RunFolder, default_directory
from train.running.warm_up import compile_first
from train.studies.conclusion import UNCHANGED, Conclusion, conclude
from train.studies.config import StudyConfig
from train.studies.export import Export
from train.studies.figure import draw_study
from train.studies.installation import study_versions
from train.studies.journal import MissionJournal
from train.studies.missions import FIGURES, STAGES, Candidate, CandidateTasks, MissionField, TaskMaker
from train.studies.report import study_summary_json, study_tables, trials_csv
from train.studies.search import Arm, CandidateSearch, StudyTrial
from train.studies.space import StudySpace
from train.studies.trial_storage import TrialStorage, importances


def run_study(
    study: StudyConfig, request: Request, console: Console, storage: str | None = None, make: TaskMaker | None = None
) -> int:
    """Do or continue a study, write its results and print its tables; return the exit code.

    Args:
        study: the study.
        request: the request of the user.
        console: shows the tables; the standard error shows the progress.
        storage: URL of the storage of trials; an SQLite file in the directory unless given.
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
    request.bits.add(noted_bits(directory))
    folder = RunFolder(directory, {"identity": identity, COMMAND: list(request.words)}, resume=request.resume)
    make = make or CandidateTasks(family, request.seed, space.goals[0], folder, directories)
    own = folder.path / "trials.sqlite"
    with noting(folder, request.bits):
        kept = TrialStorage(storage or f"sqlite:///{own.resolve()}", own="" if storage else str(own))
        journal = MissionJournal(folder, len(FIGURES))
        try:
            arms, conclusion = _searched(study, request, space, journal, make, kept)
        except (KeyboardInterrupt, WorkerLost) as end:
            return request.ended(end, folder.path, f": {journal.missions} missions are kept")
        export = Export(study, request.seed, family, space, conclusion)
        folder.write(f"knowledge/{study.name}.yaml", export.text())
        folder.write("trials.csv", trials_csv(arms, space))
        importance = importances([trial for arm in arms for trial in arm.trials], space)
        heading = f"# {study.name}\n\n{study.description}\nFamily {family.name}, seed {request.seed}.\n\n"
        publication = Publication(
            heading,
            study_tables(conclusion, space, importance),
            study_summary_json(conclusion, space, arms, importance),
            draw_study(arms, conclusion, importance, study.archive),
        )
        publish(publication, folder, console)
        export.give(request.store)
    return FINISHED


def _searched(
    study: StudyConfig,
    request: Request,
    space: StudySpace,
    journal: MissionJournal,
    make: TaskMaker,
    storage: TrialStorage,
) -> tuple[list[Arm], Conclusion]:
    """Do the missions that the journal lacks; return what each method found, and the conclusion."""
    unchanged, arms = Candidate(UNCHANGED, space.unchanged()), list[Arm]()
    if not compiled_before():
        compile_first(make(STAGES[0], unchanged, (0,)))
    bar = progress(study.method, MofNCompleteColumn(), study.trials)
    with request.engine.rounds() as done, bar as update:
        missions = MissionField(make, journal, done)
        search = CandidateSearch(study, space, missions, unchanged)
        for method in study.methods:

            def on_batch(trials: Sequence[StudyTrial], method: str = method) -> None:
                storage.keep(f"{study.name} {method} {request.seed}", trials, space, study.figures)
                told = f"trials, {journal.missions:,} missions"
                update(description=method, completed=len(trials), more=told)

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
        check_needs(Workload(family.largest, most, TASK_SCENARIOS), request.machine)
    return family, space

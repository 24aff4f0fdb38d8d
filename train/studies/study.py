"""A study from the user's request to knowledge: search, last race, statement, report, export."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.progress import MofNCompleteColumn

from clean_swarm_env.config.families import FamilyConfig
from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.warm_up import compiled_before
from selector.documents.errors import within
from train.cluster.bits import WorkerBits, noted_bits, noting
from train.cluster.chosen import chosen_engine
from train.deciders.decided_goal import DecidedGoal
from train.evaluation.trial_task import TASK_SCENARIOS
from train.knowledge_store import NO_STORE, StoreRequest
from train.reports.write_report import Publication, publish
from train.running.command import command_words
from train.running.engine import WorkerLost
from train.running.exit_codes import FAILED, FINISHED, INTERRUPTED
from train.running.needs import ALONE, Machine, Workload, check_needs
from train.running.progress import progress
from train.running.provenance import fingerprints
from train.running.run_folder import RunFolder, default_directory
from train.running.warm_up import compile_first
from train.studies.conclusion import UNCHANGED, conclude
from train.studies.config import StudyConfig
from train.studies.export import Export
from train.studies.figure import draw_study
from train.studies.installation import study_versions
from train.studies.journal import MissionJournal
from train.studies.missions import FIGURES, STAGES, Candidate, CandidateTasks, MissionField, TaskMaker
from train.studies.report import study_summary_json, study_tables, trials_csv
from train.studies.search import CandidateSearch, StudyTrial
from train.studies.space import StudySpace
from train.studies.trial_storage import TrialStorage, importances, shown_url


@dataclass(frozen=True)
class StudyRequest:
    """The request of the user."""

    study: StudyConfig
    command: tuple[str, ...]
    """Words of the command that lead to the study."""
    seed: int
    output: Path | None = None
    """Directory of the results; a new one below results/ unless given."""
    resume: bool = False
    storage: str | None = None
    """URL of the storage of trials; an SQLite file in the directory unless given."""
    store: StoreRequest = NO_STORE
    """The knowledge store that gets the result."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations, searched before the shipped one."""
    machine: Machine = ALONE
    """What the study may use."""
    bits: WorkerBits = field(default_factory=WorkerBits)
    """The CPUs that take part elsewhere."""

    @property
    def words(self) -> list[str]:
        """The command for this request, without its directory."""
        return command_words(
            *self.command,
            seed=self.seed,
            storage=None if self.storage is None else shown_url(self.storage),
            store=self.store.shown,
            force=self.machine.forced,
            configs=self.directories,
        )


def run_study(request: StudyRequest, console: Console, make: TaskMaker | None = None) -> int:
    """Do or continue a study, write its results and print its tables; return the exit code.

    Args:
        request: the request of the user.
        console: shows the tables; the standard error shows the progress.
        make: makes the tasks of candidates; missions of the family unless given.

    """
    study, directories = request.study, tuple(path.resolve() for path in request.directories)
    family, space = _checked(request)
    identity = {
        "study": study.model_dump(mode="json"),
        "family": family.model_dump(mode="json"),
        "seed": request.seed,
        "versions": study_versions(),
        "files": fingerprints(directories),
    }
    directory = request.output or default_directory(f"{study.name}-seed{request.seed}", resume=request.resume)
    request.bits.add(noted_bits(directory))
    folder = RunFolder(directory, {"identity": identity}, resume=request.resume)
    make = make or CandidateTasks(family, request.seed, space.goals[0], folder, directories)
    with noting(folder, request.bits):
        return _studied(request, family, space, folder, make, console)


def _studied(
    request: StudyRequest,
    family: FamilyConfig,
    space: StudySpace,
    folder: RunFolder,
    make: TaskMaker,
    console: Console,
) -> int:
    """Do the missions that a directory lacks, and write the results there; return the exit code."""
    study = request.study
    storage = TrialStorage(
        request.storage or f"sqlite:///{(folder.path / 'trials.sqlite').resolve()}",
        own="" if request.storage else str(folder.path / "trials.sqlite"),
    )
    journal = MissionJournal(folder, len(FIGURES))
    unchanged = Candidate(UNCHANGED, space.unchanged())
    if not compiled_before():
        compile_first(make(STAGES[0], unchanged, (0,)))
    try:
        bar = progress(study.method, MofNCompleteColumn(), study.trials)
        with chosen_engine(request.machine, request.bits).rounds() as done, bar as update:
            missions = MissionField(make, journal, done)
            search = CandidateSearch(study, space, missions, unchanged)
            arms = []
            for method in study.methods:

                def on_batch(trials: Sequence[StudyTrial], method: str = method) -> None:
                    storage.keep(f"{study.name} {method} {request.seed}", trials, space, study.figures)
                    told = f"trials, {journal.missions:,} missions"
                    update(description=method, completed=len(trials), more=told)

                arms.append(search.arm(method, request.seed, on_batch))
            conclusion = conclude(study, space, search, arms, missions)
    except (KeyboardInterrupt, WorkerLost) as end:
        command = shlex.join([*request.words, "--output", str(folder.path), "--resume"])
        what = str(end) or "interrupted"
        errors = Console(stderr=True, highlight=False, soft_wrap=True)
        errors.print(f"{what}: {journal.missions} missions are kept; to go on:\n  {command}", markup=False)
        return FAILED if isinstance(end, WorkerLost) else INTERRUPTED
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


def _checked(request: StudyRequest) -> tuple[FamilyConfig, StudySpace]:
    """Return the family and the space; an error of one line for everything that does not exist or fit."""
    study, directories = request.study, request.directories
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

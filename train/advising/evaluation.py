"""The evaluation that gives advice, and what it leaves in its folder.

That is knowledge with the scores of all options, a family that has it, and a page with the two best side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.reading import as_yaml
from selector.documents.writing import write_whole
from train.advising.advice import Advising
from train.advising.opening import document_of
from train.advising.report import Advice
from train.advising.scores import learned_from_rounds, options_known
from train.evaluation.repeat import record_run
from train.replay.page_file import write_page
from train.reports.text_table import Publication
from train.running.runs import RunRecord

KNOWLEDGE, FAMILY, REPLAY = "knowledge.yaml", "families.yaml", "replay.html"


class AdviceEvaluation(Advising):
    """Advice for a mission, a family or a task.

    Attributes:
        advice: what came out, once all runs are done and published.

    """

    advice: Advice

    def publication(self, records: Sequence[RunRecord]) -> Publication:
        """Return the advice."""
        self.advice = Advice.of(self, {record.key: record for record in records})
        return self.advice.publication

    def conclude(self) -> None:
        """Write what the advice is used with."""
        ship(self.advice)


def ship(advice: Advice) -> None:
    """Write what an advice is used with."""
    evaluation = advice.evaluation
    folder = evaluation.folder
    scores = learned_from_rounds(advice)
    learned = {goal: {name: one.model_dump() for name, one in own.items()} for goal, own in scores.items()}
    robot = evaluation.mission.network.robot
    text = document_of(
        options_known(advice),
        evaluation.directories,
        description=" ".join(advice.sentences),
        robot=robot,
        learned=learned,
    )
    write_whole(folder / KNOWLEDGE, text.encode())
    known = evaluation.opened.with_knowledge(Path(KNOWLEDGE))  # which lies beside the file
    write_whole(folder / FAMILY, as_yaml(known.model_dump(mode="json")).encode())
    order = sorted(advice.costs, key=lambda arm: float(advice.costs[arm].mean()))
    other = next((arm for arm in order if arm != advice.found.winner), None)
    recordings = []
    with TemporaryDirectory() as place:
        for number, arm in enumerate(filter(None, (advice.found.winner, other))):
            task = evaluation.task(arm, scenario_name("test", 0))
            recordings.append(RecordedMission(record_run(task, Path(place) / f"{number}.swarm"), ()))
        write_page(recordings, folder / REPLAY)

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
        advice, folder = self.advice, self.folder
        known = learned_from_rounds(advice).items()
        learned = {goal: {name: one.model_dump() for name, one in own.items()} for goal, own in known}
        text = document_of(
            options_known(advice),
            self.directories,
            description=" ".join(advice.sentences),
            robot=self.mission.network.robot,
            learned=learned,
        )
        write_whole(folder / KNOWLEDGE, text.encode())
        family = self.opened.with_knowledge(Path(KNOWLEDGE))  # which lies beside the file
        write_whole(folder / FAMILY, as_yaml(family.model_dump(mode="json")).encode())
        best, recordings = advice.found.winner, []
        others = sorted(advice.costs, key=lambda arm: (arm == best, float(advice.costs[arm].mean())))
        with TemporaryDirectory() as place:
            for number, arm in enumerate(dict.fromkeys((best, others[0]))):
                task = self.tasks_of(arm, [scenario_name("test", 0)])[0]
                path = Path(place) / f"{number}.swarm"
                record_run(task, path)
                recordings.append(RecordedMission(path, ()))
            write_page(recordings, folder / REPLAY)

"""The journal of a study: what is no line of one is refused with its place and what to do."""

import pytest

from clean_swarm_env.config.types import ConfigurationError
from train.running.run_folder import RunFolder
from train.studies.journal import MISSIONS, MissionJournal


def test_a_journal_with_fewer_figures_says_what_was_expected_and_what_to_do(tmp_path):
    folder = RunFolder(tmp_path / "run", {"identity": {}}, resume=False)
    folder.write(MISSIONS, '["race", "a", 0, 1.0, 2.0, 3.0, 4.0, 0.0]\n["race", "a", 1, 1.0, 2.0, 3.0, 4.0]\n')
    with pytest.raises(ConfigurationError) as told:
        MissionJournal(folder, 5)
    assert str(told.value).endswith(
        "missions.jsonl: line 2: expected stage, candidate, scenario and 5 figures of a finished mission, got"
        ' \'["race", "a", 1, 1.0, 2.0, 3.0, 4.0]\'; studies of other versions cannot go on: begin anew with another'
        " --output"
    )

"""One mission, recorded while it runs."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from clean_swarm_env.recording.recorder import MissionRecorder, RecordSettings
from clean_swarm_env.world.mission import Course, MissionResult, MissionRun, result_of


def record_mission(run: MissionRun, settings: RecordSettings, about: Mapping[str, Any]) -> MissionResult:
    """Run one mission to its end as `run_mission` does, and record it; `about` is plain data for the head."""
    course = Course(run, explained=settings.minds)
    recorder = MissionRecorder(course.worlds, replace(settings, thinking=True))
    recorder.open(0, {"scenario": run.start.id, "seed": run.seed, **about})
    for goal, values in course.opinions().items():  # they stay: a course teaches its strategies nothing
        recorder.think(goal, values)
    while course.in_progress:
        course.tick()
        recorder.record()
    recorder.close()
    return result_of(course.worlds, 0)

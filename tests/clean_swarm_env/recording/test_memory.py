"""What a recorder holds before it writes is bounded, however long a mission and however many worlds."""

import tracemalloc

import numpy as np
import pytest

from clean_swarm_env.recording.channels import channel_of
from clean_swarm_env.recording.recorder import MissionRecorder, RecordSettings
from clean_swarm_env.recording.taking import LEAST_FRAMES, WAITING_BYTES, Sampled, WaitingFrames
from tests.clean_swarm_env.courses import course_of
from tests.clean_swarm_env.recording.test_recorder import MISSION


@pytest.mark.parametrize(("worlds", "robots"), [(1, 5), (64, 5), (1, 10_000), (64, 10_000)])
def test_frames_that_wait_have_a_bounded_size(worlds, robots):
    numbers = np.zeros(worlds * robots, dtype=np.int64)
    sampled = [Sampled(channel_of(f"number {k}", {"robot": robots}, ""), numbers) for k in range(12)]
    steps = WaitingFrames(sampled, worlds).steps
    assert steps.shape[:2] == (worlds, 12 * robots)
    assert steps.nbytes <= max(WAITING_BYTES, LEAST_FRAMES * steps.nbytes // steps.shape[2])


def test_a_recorder_holds_no_more_after_many_parts_than_after_the_first(tmp_path):
    course = course_of(MISSION, 3, 17, explained=True)
    recorder = MissionRecorder(course.worlds, RecordSettings(tmp_path, minds=True))
    recorder.frames.room = 16
    path, held, sizes = recorder.open(0, {"scenario": "1"}), [], []
    tracemalloc.start()
    for tick in range(8 * recorder.frames.room):
        assert not course.over[0]
        course.tick()
        recorder.record()
        if tick % recorder.frames.room == recorder.frames.room - 1:
            held.append(tracemalloc.get_traced_memory()[0])
            sizes.append(path.stat().st_size)
    tracemalloc.stop()
    recorder.close()
    assert sizes == sorted(set(sizes)), "each part is written when it is full"
    part = recorder.frames.steps[:, :, : recorder.frames.room].nbytes
    assert held[-1] - held[2] < part, "five parts more were taken; the world itself grows a little"

"""Animations: every picture is there as it was, and a long one takes no more memory than a short one."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from clean_swarm_env.drawing.video import write_video

MEASURED = """
import sys
from pathlib import Path
import numpy as np
from clean_swarm_env.drawing.video import write_video

def pictures(count):
    for k in range(count):
        picture = np.full((64, 64, 3), 255, dtype=np.uint8)
        picture[k % 56 : k % 56 + 8, k // 7 % 56 : k // 7 % 56 + 8] = (0, 114, 178)
        yield picture

for count in (100, 10_000):
    write_video(Path(sys.argv[1]), pictures(count))
    print(next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM")))
"""
"""Prints the largest memory of its process [kB] after 100 pictures, and after 10,000 pictures."""


@pytest.mark.long
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="needs a system that tells the largest memory")
@pytest.mark.parametrize("name", ["a.webp", "a.gif"])
def test_ten_thousand_pictures_take_the_memory_of_a_hundred(tmp_path, name):
    done = subprocess.run([sys.executable, "-c", MEASURED, tmp_path / name], capture_output=True, text=True, check=True)
    few, many = map(int, done.stdout.split())
    assert many - few < 50_000
    assert Image.open(tmp_path / name).n_frames == 10_000


@pytest.mark.parametrize("name", ["a.webp", "a.gif"])
def test_pictures_that_change_nothing_or_little_or_all_are_shown_as_they_are(tmp_path, name):
    plain = np.full((60, 80, 3), 255, dtype=np.uint8)
    dotted, other = plain.copy(), np.zeros_like(plain)
    dotted[31:45, 53:71] = (0, 114, 178)
    corner = other.copy()
    corner[-1, -1] = 255
    pictures = [plain, plain, dotted, dotted, plain, other, corner]
    write_video(tmp_path / name, iter(pictures))
    video = Image.open(tmp_path / name)
    assert (video.n_frames, video.size, video.info["loop"]) == (len(pictures), (80, 60), 0)
    for k, picture in enumerate(pictures):
        video.seek(k)
        shown = np.asarray(video.convert("RGB")).astype(float)
        assert video.info["duration"] == 50
        assert np.abs(shown - picture).mean() < 2.0
        assert np.abs(shown[30:46, 52:72] - picture[30:46, 52:72]).mean() < 12.0

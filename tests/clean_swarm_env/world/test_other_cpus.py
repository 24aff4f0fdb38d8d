"""A course has the same bits on a CPU without fused multiply-add, as the C library and NumPy see it."""

import os
import platform
import subprocess
import sys

import pytest

COURSES = """
import hashlib
from clean_swarm_env import clean_swarm_v0

for family in ("crowded", "table1"):
    env = clean_swarm_v0.parallel_env(family=family, knowledge="avoidance")
    env.reset(seed=5)
    course = hashlib.sha256()
    for tick in range(300):
        if not env.agents:
            break
        options = {agent: (tick // 7 + row) % env.action_space(agent).n for row, agent in enumerate(env.agents)}
        _, rewards, *_ = env.step({agent: int(option) for agent, option in options.items()})
        course.update(repr(sorted(rewards.items())).encode() + env.state().tobytes())
    print(family, course.hexdigest())
"""
WITHOUT_FMA = {
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX512VL",
    "NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 AVX512F AVX512_SKX",
}


@pytest.mark.skipif(
    platform.machine() != "x86_64" or platform.libc_ver()[0] != "glibc",
    reason="glibc on x86-64 can be told to leave out what the CPU has",
)
def test_a_course_has_the_same_bits_without_fused_multiply_add():
    courses = [
        subprocess.run(
            [sys.executable, "-c", COURSES], env=os.environ | extra, capture_output=True, text=True, check=True
        ).stdout
        for extra in ({}, WITHOUT_FMA)
    ]
    assert courses[0].count("\n") == 2
    assert courses[0] == courses[1]

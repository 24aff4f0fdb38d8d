"""What docs/clusters.md shows works: warm, shares, gather, and the printed job array."""

import os
import re
import shlex
import subprocess

import pytest
import yaml

from tests.paths import ROOT
from tests.train.commands import run

PAGE = (ROOT / "docs" / "clusters.md").read_text(encoding="utf-8")


def commands(name: str) -> list[list[str]]:
    """Return the words of each command in a marked block."""
    [block] = re.findall(rf"<!-- ci: {name} -->\n```sh\n(.*?)```", PAGE, flags=re.DOTALL)
    return [shlex.split(line)[1:] for line in block.replace("\\\n", "").splitlines()]


def test_shares_and_the_job_array_give_equal_results(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    for words in commands("shares"):
        assert run(*words) == 0, capsys.readouterr().err
    capsys.readouterr()
    [[*words, redirection, script]] = commands("script")
    assert redirection == ">"
    assert run(*words) == 0
    (tmp_path / script).write_text(capsys.readouterr().out)
    for number in "123":
        given = {**os.environ, "PYTHONPATH": str(ROOT), "SLURM_ARRAY_TASK_ID": number}
        subprocess.run(["sh", script], check=True, env=given, capture_output=True)
    assert run("gather", "results/array") == 0
    for name in ("summary.json", "table.md"):
        shared, array = (tmp_path / "results" / folder / name for folder in ("shared", "array"))
        assert shared.read_bytes() == array.read_bytes()


def test_dask_knows_the_settings():
    dask = pytest.importorskip("dask", reason="Dask is not installed (extra `cluster`)")
    pytest.importorskip("distributed")
    [text] = re.findall(r"```yaml\n(distributed:\n.*?)```", PAGE, flags=re.DOTALL)

    def check(given: dict[str, object], known: dict[str, object]) -> None:
        assert given.keys() <= known.keys()
        for name, value in given.items():
            if isinstance(value, dict) and name != "pre-spawn-environ":  # any variables
                check(value, known[name])

    check(yaml.safe_load(text), dask.config.config)


def test_warm_compiles_and_says_where(capsys):
    assert "clean-swarm machine warm " in PAGE
    assert run("machine", "warm") == 0
    assert re.fullmatch(r"compiled code: \d+ MB in \S+, [\d.]+ CPU s\n", capsys.readouterr().out)

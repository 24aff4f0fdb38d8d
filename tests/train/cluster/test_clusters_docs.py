"""What docs/clusters.md shows works: `warm`, the places of `--on`, and the settings of Dask and of its jobs."""

import re

import pytest
import yaml

from tests.paths import ROOT
from tests.train.commands import told
from train.cli import warm
from train.running.dask_engine import CLUSTERS, PLACE

PAGE = (ROOT / "docs" / "clusters.md").read_text(encoding="utf-8")


def test_the_page_names_every_scheduler_and_only_places_that_there_are():
    assert all(f"`{name}:JOBS`" in PAGE or f"--on {name}:JOBS`" in PAGE for name in CLUSTERS)
    shown = re.findall(r"--on (\S+:\d+)$", PAGE, flags=re.MULTILINE)
    assert len(shown) >= 2
    assert all(PLACE.fullmatch(place) for place in shown)


@pytest.mark.extra
def test_dask_knows_the_settings():
    dask = pytest.importorskip("dask", reason="Dask is not installed (extra `cluster`)")
    pytest.importorskip("distributed")
    pytest.importorskip("dask_jobqueue")

    def check(given: dict[str, object], known: dict[str, object]) -> None:
        assert given.keys() <= known.keys()
        for name, value in given.items():
            if isinstance(value, dict) and name != "pre-spawn-environ":  # any variables
                check(value, known[name])

    found = re.findall(r"```yaml\n(.*?)```", PAGE, flags=re.DOTALL)
    assert len(found) == 2
    for text in found:
        check(yaml.safe_load(text), dask.config.config)


@pytest.mark.parametrize("compiled", [pytest.param(True, marks=pytest.mark.long), False])
def test_warm_compiles_and_says_where(compiled, capsys, monkeypatch):
    done = []
    if not compiled:
        monkeypatch.setattr(warm, "_compile_everything", lambda: done.append(True))
    assert "clean-swarm warm  " in PAGE
    code, out, err = told(capsys, "warm")
    assert (code, done) == (0, [] if compiled else [True]), err
    assert re.fullmatch(r"compiled code: \d+ MB in \S+, [\d.]+ CPU s\n", out)


def test_warm_without_a_directory_for_the_code_is_one_line(capsys, monkeypatch):
    monkeypatch.setattr("selforg.compiler.cache.cache_directory", lambda: None)
    assert told(capsys, "warm") == (
        2,
        "",
        "error: warm: no directory can be written or has room; NUMBA_CACHE_DIR names another one\n",
    )

"""A server that goes away in the middle and comes back: one line, and no update is lost or counted twice."""

import os
import subprocess
import sys

import numpy as np
import pytest
from sqlalchemy import make_url

from selector.store import KnowledgeStore, RewardSums, StoreError
from selector.store.tables import learned
from tests.paths import ROOT
from tests.selector.store.servers.losing_server import Way
from tests.train.cli.test_faults import wait_for_runs


@pytest.fixture
def way(new_url):
    """A way to an empty database, and its URL."""
    url = make_url(new_url())
    made = Way(url.port)
    yield made, url.set(port=made.port).render_as_string()
    made.cut()


def rewards(*given):
    sums = RewardSums("Avoid", ("near",))
    sums.record(np.zeros(len(given), dtype=np.int64), np.array(given))
    return sums


def count(store):
    return store.contents().totals()["Avoid", "near", ""].count


only_servers = pytest.mark.parametrize("new_url", ["postgres"], indirect=True)


@only_servers
def test_a_store_says_so_in_one_line_and_goes_on_when_the_server_is_back(way, capfd):
    between, url = way
    store = KnowledgeStore(url)
    store.add(rewards(1.0), source="a")
    between.cut()
    for call in (lambda: store.add(rewards(2.0), source="a"), store.contents, lambda: KnowledgeStore(url)):
        with pytest.raises(StoreError) as failed:
            call()
        assert str(failed.value).startswith("postgresql://tester@127.0.0.1:")
        assert "\n" not in str(failed.value)
    between.mend()
    assert count(store) == 1
    store.add(rewards(3.0), source="a")
    assert count(store) == 2
    store.close()
    assert capfd.readouterr().err == ""


@only_servers
def test_an_update_during_which_the_server_goes_away_does_not_count(way, capfd):
    between, url = way
    store = KnowledgeStore(url)
    store.add(rewards(1.0), source="a")

    def change():
        with store._writing() as connection:
            connection.execute(learned.delete())
            between.cut()

    with pytest.raises(StoreError, match="network error"):
        change()
    between.mend()
    assert count(store) == 1
    store.close()
    assert capfd.readouterr().err == ""


@only_servers
def test_an_evaluation_keeps_its_runs_and_gives_its_scores_when_the_server_is_back(way, tmp_path):
    between, url = way
    words = ["evaluate", "--scenarios", "3", "--workers", "1", "--store", url, "--learn", "--output", "r"]
    command = [sys.executable, "-m", "tests.train.fake_mission", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "FAKE_SECONDS": "0.2"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(command, cwd=tmp_path, env=environment, **pipes)
    wait_for_runs(process, tmp_path / "r", 1)
    between.cut()
    _, err = process.communicate(timeout=120)
    assert process.returncode == 2
    assert "postgresql://tester@127.0.0.1:" in err
    assert "Traceback" not in err
    assert 1 <= len((tmp_path / "r" / "runs.jsonl").read_text().splitlines()) < 6
    between.mend()
    for _ in range(2):  # going on once more changes nothing
        done = subprocess.run([*command, "--resume"], cwd=tmp_path, env=environment, timeout=300, **pipes)
        assert done.returncode == 0, done.stderr
        store = KnowledgeStore(url)
        assert sum(entry.moments.count for entry in store.contents().learned.values()) == 6
        store.close()
    assert len((tmp_path / "r" / "runs.jsonl").read_text().splitlines()) == 6

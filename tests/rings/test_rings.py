"""Long tests run again exactly where the record is not of the sources that are there."""

import json
import re
import shutil
import subprocess

import pytest

from tests.rings import durations
from tests.rings.long import PACKAGES, files_of, fingerprints, needed, outcomes, package_of, sealed


@pytest.fixture
def checkout(tmp_path):
    """A small checkout with a file of each package and its tests."""
    root = tmp_path / "checkout"
    for name in ("selforg", "selector", "clean_swarm_env", "configs", "train", "docs"):
        for place in (root / name, root / "tests" / name):
            place.mkdir(parents=True)
            (place / f"test_{name}.py").write_text("")
    (root / "tests" / "conftest.py").write_text("")
    subprocess.run(["git", "init", "-q", root], check=True)
    return root


@pytest.fixture
def record(checkout, tmp_path):
    """A record of the checkout as it is."""
    packages = {name: {"sources": found, "passed": 1} for name, found in fingerprints(checkout).items()}
    path = tmp_path / "long.json"
    path.write_text(json.dumps({"packages": packages, "table": sealed(packages)}))
    return path


@pytest.mark.parametrize(
    ("changed", "again"),
    [
        ("selforg/test_selforg.py", PACKAGES),
        ("tests/conftest.py", PACKAGES),
        ("tests/selforg/new.py", PACKAGES),
        ("configs/test_configs.py", ("clean_swarm_env", "train", "pages")),
        ("train/test_train.py", ("train", "pages")),
        ("tests/selector/test_selector.py", ("selector",)),
        ("tests/train/test_train.py", ("train",)),
        ("docs/test_docs.py", ("pages",)),
        ("tests/long.json", ()),
        ("unrelated.txt", ()),
    ],
)
def test_a_change_asks_for_the_package_and_those_above_it(checkout, record, changed, again):
    assert needed(record, checkout) == []
    (checkout / changed).write_text("changed = True\n")
    assert needed(record, checkout) == [*again]


def test_a_removed_file_is_a_change(checkout, record):
    shutil.rmtree(checkout / "train")
    assert needed(record, checkout) == ["train", "pages"]


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (lambda text: text.replace('"passed": 1', '"passed": 2'), "not that of the table"),
        (lambda text: text.replace('"table": "', '"table": "0'), "not that of the table"),
        (lambda text: text[:-20], "is damaged"),
        (lambda text: "[]", "is damaged"),
        (lambda text: json.dumps({"packages": [], "table": sealed([])}), "is damaged"),
        (lambda text: '{"packages": {}}', "is damaged"),
    ],
)
def test_of_a_forged_or_damaged_record_all_run(checkout, record, capsys, damage, said):
    record.write_text(damage(record.read_text()))
    assert needed(record, checkout) == [*PACKAGES]
    assert re.search(said, capsys.readouterr().out)


def test_without_a_record_all_run(checkout, tmp_path):
    assert needed(tmp_path / "none.json", checkout) == [*PACKAGES]


def test_every_test_belongs_to_one_package():
    listed = [files_of([package]) for package in PACKAGES]
    assert all(listed)
    assert sum(map(len, listed)) == len(set().union(*listed)) == len(files_of([*PACKAGES]))
    assert (package_of("selector/test_knowledge.py"), package_of("test_house.py")) == ("selector", "pages")


def test_the_report_of_pytest_is_counted_by_files(tmp_path):
    (tmp_path / "report.xml").write_text(
        """<testsuites><testsuite>
        <testcase classname="tests.train.test_one" name="a" time="1.5"/>
        <testcase classname="tests.train.test_one.TestIt" name="b" time="1"><failure/></testcase>
        <testcase classname="tests.test_two" name="c" time="0"><skipped message="no Chromium"/></testcase>
        <testcase classname="tests.test_two" name="d" time="0"><skipped message="needs ray: make examples"/></testcase>
        </testsuite></testsuites>"""
    )
    assert outcomes(tmp_path / "report.xml") == {
        "train/test_one.py": {"passed": 1, "failed": 1, "seconds": 2.5},
        "test_two.py": {"skipped": 1, "elsewhere": 1, "seconds": 0},
    }


def test_the_table_of_durations_is_as_it_would_be_written(tmp_path):
    again = tmp_path / "durations.csv"
    durations.replace((), durations.read(), again)
    assert again.read_bytes() == durations.TABLE.read_bytes()


def test_minutes_in_contributing_are_those_of_the_table():
    assert durations.minutes(durations.read()) in durations.CONTRIBUTING.read_text(encoding="utf-8")

"""`make long`: the tests that take long, and the record of what they were last green for, `tests/long.json`.

`python -m tests.rings.long [--needed] [PACKAGE...]` runs those of all packages, of some, or with `--needed` of those
whose record is not of the sources that are there. A record holds, for each package, a hash of the files that decide the
result: its own sources and tests, the sources of the packages below it, and what helps tests. A hash over the table
finds a record that was damaged or written by hand; then all tests run. A package of which a test failed or was skipped
gets no record.
"""

import argparse
import hashlib
import json
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections import defaultdict
from pathlib import Path
from typing import Any

from tests.paths import ROOT
from tests.rings.durations import GATE, replace, run

RECORD = ROOT / "tests" / "long.json"
LAYERS = (
    ("selforg", ("selforg",)),
    ("selector", ("selector",)),
    ("clean_swarm_env", ("clean_swarm_env", "configs")),
    ("train", ("train",)),
    ("pages", ("docs", "examples", "benchmarks", "README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")),
)
"""The packages from the bottom to the top with their sources; `pages` has all other tests, too."""
PACKAGES = tuple(package for package, _ in LAYERS)
EVERYWHERE = ("pyproject.toml", "constraints.txt")
ELSEWHERE = ("make examples", "by hand")
"""What the reason says of a test that is skipped because another command, or a person, installs what it needs."""
UNREAD = ("tests/long.json", "tests/durations.csv")
"""What tests write about themselves."""


def package_of(test: str) -> str:
    """Return the package to which a test file belongs, by its path below tests/."""
    first = test.partition("/")[0]
    return first if first in PACKAGES else "pages"


def fingerprints(root: Path = ROOT) -> dict[str, str]:
    """Return for each package the hash of all that decides the result of its long tests."""
    words = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(words, cwd=root, capture_output=True, text=True, check=True).stdout.split("\0")
    files = sorted(name for name in set(listed) - {"", *UNREAD} if (root / name).is_file())
    contents = {name: hashlib.sha256((root / name).read_bytes()).hexdigest() for name in files}
    decisive, found = {*EVERYWHERE}, {}
    for package, sources in LAYERS:
        decisive |= {*sources}
        lines = [
            f"{name} {content}\n"
            for name, content in contents.items()
            if name in decisive or name.partition("/")[0] in decisive or counts_for(package, name)
        ]
        found[package] = hashlib.sha256("".join(lines).encode()).hexdigest()
    return found


def counts_for(package: str, name: str) -> bool:
    """Return whether a file is a test of a package, or may help tests of any package."""
    top, _, rest = name.partition("/")
    return top == "tests" and (package_of(rest) == package or not Path(rest).name.startswith("test_"))


def sealed(packages: dict[str, Any]) -> str:
    """Return the hash over the table of a record."""
    return hashlib.sha256(json.dumps(packages, sort_keys=True).encode()).hexdigest()


def recorded(path: Path = RECORD) -> dict[str, Any]:
    """Return the packages of a record; none if it is missing, damaged or forged."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        packages: dict[str, Any] = found["packages"]
        if found["table"] == sealed(packages):
            return {name: packages[name] for name in PACKAGES if name in packages.keys()}  # noqa: SIM118  (or no table)
        print(f"{path.name}: the hash is not that of the table; all long tests run")
    except FileNotFoundError:
        print(f"{path.name}: no such file; all long tests run")
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        print(f"{path.name}: is damaged; all long tests run")
    return {}


def needed(path: Path = RECORD, root: Path = ROOT) -> list[str]:
    """Return the packages whose record is not of the sources that are there."""
    known, now = recorded(path), fingerprints(root)
    return [package for package in PACKAGES if known.get(package, {}).get("sources") != now[package]]


def files_of(packages: list[str]) -> list[str]:
    """Return the test files and folders of some packages."""
    top = sorted(path.name for path in (ROOT / "tests").iterdir() if path.is_dir() or path.name.startswith("test_"))
    return [f"tests/{name}" for name in top if package_of(name) in packages and not name.startswith(("__", "."))]


def outcomes(report: Path) -> dict[str, dict[str, float]]:
    """Return for each test file how many passed, failed and were skipped, from a report of pytest in JUnit's form."""
    table: dict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))
    for case in ET.parse(report).iter("testcase"):
        words = case.get("classname", "").split(".")
        last = max((k for k, word in enumerate(words) if word.startswith("test_")), default=len(words) - 1)
        row = table["/".join(words[1 : last + 1]) + ".py"]
        ends = {child.tag: child.get("message", "") for child in case}
        skipped = "elsewhere" if any(words in ends.get("skipped", "") for words in ELSEWHERE) else "skipped"
        row["failed" if ends.keys() & {"failure", "error"} else skipped if "skipped" in ends else "passed"] += 1
        row["seconds"] += float(case.get("time", 0))
    return table


def main() -> int:
    """Run long tests, print their table, write the record of what is green; return 1 if anything failed."""
    parser = argparse.ArgumentParser(description="Run the tests that take long.")
    parser.add_argument("packages", nargs="*", metavar="PACKAGE", help=f"of {', '.join(PACKAGES)}; all unless given")
    parser.add_argument("--needed", action="store_true", help="only where the record is not of these sources")
    given = parser.parse_args()
    if wrong := set(given.packages) - set(PACKAGES):
        parser.error(f"unknown package: {', '.join(sorted(wrong))} (known: {', '.join(PACKAGES)})")
    packages = needed() if given.needed else given.packages or [*PACKAGES]
    if not packages:
        print("the long tests were green for these sources")
        return 0
    before = fingerprints()
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        words = [*GATE, "-vv", "-m", "long", f"--junit-xml={report}", *files_of(packages)]
        code, times = run(words, "long", "`make long`")
        table = outcomes(report) if report.exists() else {}
    print("| file | passed | failed | skipped | seconds |", "|---|---|---|---|---|", sep="\n")
    for name, row in sorted(table.items(), key=lambda item: -item[1]["seconds"]):
        print(f"| {name} | {row['passed']:.0f} | {row['failed']:.0f} | {row['skipped']:.0f} | {row['seconds']:.0f} |")
    bad = {package_of(name) for name, row in table.items() if row["failed"] or row["skipped"]}
    after = fingerprints()
    bad |= {package for package in packages if code not in (0, 1, 5) or before[package] != after[package]}
    if set(packages) == set(PACKAGES) and not code:
        replace({"long"}, times)
    known, now = recorded(), fingerprints()  # the table of minutes in CONTRIBUTING is one of the sources
    for package in packages:
        known.pop(package, None)
        if package not in bad:
            passed = sum(row["passed"] for name, row in table.items() if package_of(name) == package)
            known[package] = {"sources": now[package], "passed": int(passed)}
    RECORD.write_text(json.dumps({"packages": known, "table": sealed(known)}, indent=1) + "\n", encoding="utf-8")
    print("recorded as green:", ", ".join(name for name in PACKAGES if name in known) or "nothing")
    return 1 if code not in (0, 5) else 0


if __name__ == "__main__":
    sys.exit(main())

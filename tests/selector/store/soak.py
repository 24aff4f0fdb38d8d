"""`python -m tests.selector.store.soak [FACTOR]`: FACTOR (10) times the kills and updates of a test run."""

import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

from tests.selector.store import hammer, killing, postgres_server
from tests.soaking import report


@contextmanager
def _databases() -> Iterator[list[str]]:
    """Yield the URLs with which each program runs: SQLite, and PostgreSQL where it is installed."""
    with tempfile.TemporaryDirectory() as directory:
        urls = [f"sqlite:///{directory}/store-{{}}.sqlite"]
        binaries = postgres_server.programs()
        if binaries is None:
            print("PostgreSQL is not installed: SQLite alone")
            yield urls
            return
        with postgres_server.running(binaries) as url:
            yield [*urls, url]


def main(arguments: list[str]) -> int:
    factor = int(arguments[0]) if arguments else 10
    failed, tried, mistakes = 0, 0, 0
    with _databases() as urls:
        for url in urls:
            print(url.partition(":")[0], flush=True)
            failed += hammer.main([url.replace("{}", "hammer"), "8", str(500 * factor)])
            kills, wrong = killing.kill_many(url, 200 * factor)
            tried, mistakes = tried + kills, mistakes + wrong
    report(tried, tried - mistakes)
    return 1 if failed or mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

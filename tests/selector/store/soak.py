"""`python -m tests.selector.store.soak [ROUNDS]`: as many (10) rounds of the kills and updates of a test run."""

import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

from selector.store import KnowledgeStore
from tests.selector.store import hammer, killing
from tests.selector.store.servers import postgres_server
from tests.soaking import report, rounds


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
    count = int(arguments[0]) if arguments else 10
    failed, tried, mistakes = 0, 0, 0
    with _databases() as urls:
        for number in rounds(count):
            for url in urls:
                print(url.partition(":")[0], flush=True)
                here = url.replace("{}", f"{number}-{{}}")
                store = KnowledgeStore(here)
                store.reset()  # a server has one database for all rounds
                store.close()
                failed += hammer.main([here.replace("{}", "hammer"), "8", "500"])
                kills, wrong = killing.kill_many(here, 200, number)
                tried, mistakes = tried + kills, mistakes + wrong
    report(tried, tried - mistakes)
    return 1 if failed or mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

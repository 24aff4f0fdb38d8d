import itertools
from collections.abc import Callable, Iterator

import pytest
from sqlalchemy import create_engine, text

from selector.store import KnowledgeStore
from tests.selector.store.servers import postgres_server

NUMBERS = itertools.count()


@pytest.fixture(scope="session")
def postgres() -> Iterator[str]:
    """URL of a database on a server that runs for the whole session."""
    binaries = postgres_server.programs()
    if binaries is None:
        pytest.skip("PostgreSQL is not installed (Debian: apt-get install postgresql)")
    pytest.importorskip("pg8000", reason="the driver of PostgreSQL is not installed (extra `postgres`)")
    with postgres_server.running(binaries) as url:
        yield url


@pytest.fixture(params=["sqlite", "postgres"])
def new_url(request, tmp_path) -> Callable[[], str]:
    """Make the URL of a database that is still empty; one of SQLite or of PostgreSQL."""
    if request.param == "sqlite":
        return lambda: f"sqlite:///{tmp_path}/store-{next(NUMBERS)}.sqlite"
    server = request.getfixturevalue("postgres")

    def create() -> str:
        name = f"store_{next(NUMBERS)}"
        engine = create_engine(server.replace("postgresql:", "postgresql+pg8000:"), isolation_level="AUTOCOMMIT")
        with engine.connect() as connection:
            connection.execute(text(f"CREATE DATABASE {name}"))
        engine.dispose()
        return f"{server.rpartition('/')[0]}/{name}"

    return create


@pytest.fixture
def new_store(new_url) -> Iterator[Callable[[], KnowledgeStore]]:
    """Make an empty store; all are closed after the test."""
    opened = []

    def make() -> KnowledgeStore:
        opened.append(KnowledgeStore(new_url()))
        return opened[-1]

    yield make
    for store in opened:
        store.close()

"""A PostgreSQL server of Debian's packages for the time of a test: own data directory, free port, unprivileged user."""

import os
import pwd
import shutil
import socket
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

USER = "tester"


def programs() -> Path | None:
    """Return the directory with initdb and pg_ctl, None where PostgreSQL is not installed."""
    newest = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda path: int(path.parts[-3]))
    found = str(newest[-1]) if newest else shutil.which("initdb")
    return Path(found).resolve().parent if found else None


@contextmanager
def running(binaries: Path) -> Iterator[str]:
    """Start a server and yield the URL of an empty database on it; stop it at the end."""
    home = Path(tempfile.mkdtemp(prefix="clean-swarm-postgres-"))
    unprivileged = _unprivileged(home)
    data, port = home / "data", _free_port()
    settings = f"-p {port} -k {home} -c listen_addresses=127.0.0.1 -c fsync=off"

    def run(program: str, *words: str) -> None:
        command = [str(binaries / program), "-D", str(data), *words]
        with (home / f"{program}.log").open("ab") as log:  # a pipe would stay open in the server
            subprocess.run(command, check=True, cwd=home, stdout=log, stderr=log, **unprivileged)

    try:
        run("initdb", "-A", "trust", "-U", USER, "--no-sync", "-E", "UTF8", "--locale=C")
        run("pg_ctl", "-w", "-l", str(home / "server.log"), "-o", settings, "start")
        try:
            yield f"postgresql://{USER}@127.0.0.1:{port}/postgres"
        finally:
            run("pg_ctl", "-w", "-m", "immediate", "stop")
    finally:
        shutil.rmtree(home, ignore_errors=True)


def _unprivileged(home: Path) -> dict[str, object]:
    """Return what makes a subprocess run as an ordinary user, who owns `home`: PostgreSQL refuses root."""
    if os.geteuid() != 0:
        return {}
    names = {entry.pw_name for entry in pwd.getpwall()}
    account = pwd.getpwnam("postgres" if "postgres" in names else "nobody")
    os.chown(home, account.pw_uid, account.pw_gid)
    return {"user": account.pw_uid, "group": account.pw_gid, "extra_groups": []}


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])

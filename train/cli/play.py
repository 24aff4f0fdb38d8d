"""`clean-swarm play`: a mission that runs in the browser and can be changed by hand."""

from __future__ import annotations

import os
import sys
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import chain, count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from selector.documents.plain import DocumentError as ConfigurationError
from selector.documents.plain import shown
from selforg.plugins import named_plugins
from train.cli.listing import check_named
from train.cli.options import MOST_SCENARIOS, MOST_SEED, Configs, Seed, check_whole

if TYPE_CHECKING:  # imports Numba
    from train.live.chosen import PlayedMission
    from train.live.session import Session

MOST_PORT = 65_535
MINDS_UP_TO = 30
"""Robots up to which minds are shown unless asked for: the page unpacks them all in every control period."""


def play_command(
    name: Annotated[
        str,
        typer.Argument(
            help="Name of a mission, family, experiment or task, or path to a YAML file; or a recording of a play.",
            metavar="[MISSION|FAMILY|TASK|RECORDING]",
        ),
    ] = "crowded-exploring",
    strategy: Annotated[
        str | None,
        typer.Option(help="Strategy of the robots, as for `evaluate`; MaxScore, or the best option, unless given."),
    ] = None,
    knowledge: Annotated[str | None, typer.Option(help="Expert knowledge in place of the mission's.")] = None,
    scenario: Annotated[int, typer.Option(help="Number of the start configuration or the scenario, from 1 on.")] = 1,
    seed: Seed = 0,
    speed: Annotated[float, typer.Option(help="Seconds of the mission in a second; the page can change it.")] = 1.0,
    port: Annotated[int, typer.Option(help="Port on 127.0.0.1; any free one unless given.")] = 0,
    output: Annotated[
        Path | None, typer.Option(help="Recording to write, NAME.swarm; a new one below results/ unless given.")
    ] = None,
    minds: Annotated[
        bool | None,
        typer.Option(help=f"Show what the robots' networks decide; by default for up to {MINDS_UP_TO} robots."),
    ] = None,
    paused: Annotated[bool, typer.Option("--paused", help="Wait for a click on Play.")] = False,
    browser: Annotated[bool, typer.Option(help="Open the page, where there is a screen.")] = True,
    configs: Configs = None,
) -> None:
    """Run a mission in the browser: pause, step, drag, add and remove robots and garbage, switch strategies.

    It begins as soon as its page is open. What is done by hand is recorded, and `clean-swarm play RECORDING` runs the
    same mission again.
    """
    check_whole({"--scenario": (scenario, 1, MOST_SCENARIOS), "--seed": (seed, 0, MOST_SEED)})
    check_whole({"--port": (port, 0, MOST_PORT)})
    directories = tuple(configs or ())
    mission = None if name.endswith(".swarm") else name
    check_named(directories, name=mission, knowledge=knowledge)
    if sys.stderr.isatty():
        typer.echo(f"starting {name}; on a new machine it compiles first, about a minute", err=True)
    from train.live.chosen import chosen, playable, remarks  # imports Numba
    from train.live.conductor import Conductor, checked_speed
    from train.live.server import LiveServer
    from train.live.session import Session
    from train.replay.page_file import live_page

    recorded: list[Path] = []

    def opened(choose: Callable[[], PlayedMission]) -> Session:
        play = choose()
        recorded.append(_new_file(output, play.name))
        few = play.scenario.mission.robots.count <= MINDS_UP_TO
        return Session(play, recorded[-1], minds=few if minds is None else minds)

    checked_speed(speed)
    play = chosen(name, scenario, seed, strategy, directories, knowledge)
    for remark in remarks(play):
        typer.echo(remark, err=True)
    if output is not None and output.exists():
        raise ConfigurationError(f"--output: {output} exists already; expected a new file")
    sessions = {
        "": partial(opened, lambda: play),
        **{
            other: partial(opened, partial(chosen, other, 1, seed, None, directories))
            for other in playable(directories)
        },
    }
    with LiveServer(port) as server:
        conductor = Conductor(sessions, speed, playing=not paused)
        server.start(conductor, live_page())
        try:  # who has read the address may end it at once
            typer.echo(f"{server.address}\nopen this address in a browser; Ctrl-C ends it")
            with _redirect(server.address, recorded[0].parent) as page:
                if browser and _has_screen():
                    webbrowser.open(page.as_uri())
                conductor.run()
        finally:
            steps, again = conductor.session.ticks, " or ".join(map(str, recorded))
            read = "".join(f" --import {shown(Path(one)) if os.sep in one else one}" for one in named_plugins())
            typer.echo(f"{steps} steps in {recorded[-1]}; the same again: clean-swarm play {again}{read}")
            conductor.session.close()  # an interruption may come before `run`


@contextmanager
def _redirect(address: str, folder: Path) -> Iterator[Path]:
    """Give a page that leads to an address, which other users can read neither there nor among the processes.

    It is below `folder`, because browsers in a sandbox may not read the directory of temporary files.
    """
    with TemporaryDirectory(prefix="open-", dir=folder) as private:  # mode 0700
        page = Path(private).resolve() / "play.html"
        page.touch(0o600)
        page.write_text(f'<!doctype html><meta http-equiv="refresh" content="0; url={address}">', encoding="utf-8")
        yield page


def _new_file(wanted: Path | None, name: str) -> Path:
    """Return the path of a recording that does not exist yet: the wanted one, or one beside it."""
    folder = Path("results") if wanted is None else wanted.parent
    paths = (folder / f"play-{name}-{number}.swarm" for number in count(1))
    return next(path for path in chain(filter(None, (wanted,)), paths) if not path.exists())


def _has_screen() -> bool:
    """Return whether a browser with windows can be opened; one in a terminal would fill it."""
    return sys.platform in ("darwin", "win32") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))

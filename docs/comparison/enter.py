"""Judges an entrant beside the strategies of the protocol: `python -m docs.comparison.enter FILE`.

FILE is a state machine (.yaml), a network (.onnx, with names of observations and options in the .json beside it), a zip
of the two files of a policy (.zip), or Python code with one class below `OptionDecider` (.py). It does the public
scenarios of the protocol, on which all others were judged, and as many that nobody has seen: the seed of these is the
beginning of the SHA-256 of the file, so whoever changes the file changes the scenarios.

Missions are kept in results/entrants, by that digest, and what is there is not done again. A .yaml, .onnx or .zip is
read as data. A plug-in is code, which may do whatever its user may.
"""

import argparse
import hashlib
import sys
from contextlib import redirect_stdout
from pathlib import Path, PurePosixPath
from typing import Any
from zipfile import BadZipFile, ZipFile
from zlib import error as zlib_error

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.families import scenario_name
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.decider import OptionDecider
from clean_swarm_env.deciders.named import DECIDERS, MACHINE, POLICY, NamedDecider
from clean_swarm_env.learning.observation.observer import Observations
from docs.comparison.acceptance import OWN, acceptance_tables, acceptances, figures_of
from docs.comparison.manifest import Manifest
from docs.comparison.missions import do_missions, family_of, read_missions
from docs.figures.stored import ROOT
from selector.documents.errors import validated, within
from selector.documents.plain import short
from selector.documents.reading import DOCUMENT_BYTES, read_bytes, read_mapping
from selector.documents.trust import permission_of, permitting
from selector.documents.writing import write_whole
from selector.strategies.policy_file import SPECIFICATION, WEIGHTS_FILE
from selforg.plugins import PluginError, guard, import_named, module_of
from train.analysis.verdict import RANDOM
from train.cli.interruption import Interruption
from train.running.commands import BAD_INPUT, INTERRUPTED
from train.running.trial_task import TrialTask

ENTRANT = "entrant"
"""Label of what is judged."""


def main(arguments: list[str]) -> None:
    """Judge the entrant that the words of a command name."""
    parser = argparse.ArgumentParser(prog="python -m docs.comparison.enter")
    parser.add_argument("file", type=Path, help="machine (.yaml), network (.onnx), zipped policy (.zip), plug-in (.py)")
    parser.add_argument("--manifest", type=Path, default=OWN, help="families, with missions that are kept beside it")
    given = parser.parse_args(arguments)
    try:
        with Interruption(), redirect_stdout(sys.stderr), permitting(permission_of([str(given.file)], trusted=False)):
            found = judged(given.file, given.manifest)
    except (ConfigurationError, PluginError) as error:
        parser.exit(BAD_INPUT, f"error: {error}\n")
    except KeyboardInterrupt:
        parser.exit(INTERRUPTED, "interrupted: what is done stays, and the same command goes on\n")
    print(found)


def judged(file: Path, given: Path) -> str:
    """Do the missions of an entrant that are missing; return its tables and verdicts, which are also written."""
    manifest, digest = validated(Manifest, read_mapping(given), str(given)), digest_of(file)
    kept, output = read_missions(given.with_suffix(".jsonl"), manifest), ROOT / "results" / "entrants" / digest[:16]
    public = entry(manifest, strategy_of(file, output), manifest.seed)
    fresh = entry(manifest, public.strategies[ENTRANT], int(digest[:8], 16))
    check_fits(file, public)
    missions = kept | do_missions(public, output / "public.jsonl", kept)
    own = do_missions(fresh, output / "own.jsonl")
    if digest_of(file) != digest:
        raise ConfigurationError(f"{file}: expected the content with which the missions began, got another")
    everybody = manifest.model_copy(update={"strategies": public.strategies | manifest.strategies})
    beside, alone = figures_of(everybody, missions), figures_of(fresh, own)
    verdicts = [acceptances(manifest, figures)[ENTRANT].verdict for figures in (beside, alone)]
    said = [f"Scenarios of seed {one.seed}: {verdict}" for one, verdict in zip((public, fresh), verdicts, strict=True)]
    shown = [*acceptance_tables(manifest, beside).values(), acceptance_tables(fresh, alone)["ratios"]]
    found = "\n\n".join([f"{file.name}, sha256 {digest}", *said, *shown])
    write_whole(output / "table.md", f"{found}\n".encode())
    return found


def entry(manifest: Manifest, strategy: str, seed: int) -> Manifest:
    """Return what an entrant does: its missions and those of the fixed options on all families."""
    untold: dict[str, Any] = {"told": {}, "told_by": {}, "off": None}
    families = {name: one.model_copy(update=untold) for name, one in manifest.families.items()}
    own = {"strategies": {ENTRANT: strategy}, "trained": {}, "only": {RANDOM: ()}, "families": families, "seed": seed}
    return manifest.model_copy(update=own)


def digest_of(file: Path) -> str:
    """Return the SHA-256 of an entrant, with that of the names beside a network."""
    names = file.with_suffix(".json")
    beside = read_bytes(names) if file.suffix == ".onnx" and names.exists() else b""
    return hashlib.sha256(read_bytes(file) + beside).hexdigest()


def strategy_of(file: Path, output: Path) -> str:
    """Return the strategy of a file, as `--strategy` takes it; that of a zip is unpacked in the directory `output`."""
    match file.suffix:
        case ".yaml" | ".yml":
            return f"{MACHINE}:{file}"
        case ".onnx":
            return f"{POLICY}:{file}"
        case ".zip":
            return f"{POLICY}:{_unpacked(file, output / 'policy')}"
        case ".py":
            return _plugged(file)
    raise ConfigurationError(f"{file}: expected a file that ends in .yaml, .onnx, .zip or .py, got {file.name}")


def _unpacked(file: Path, output: Path) -> Path:
    """Write the two files of a policy, which have to be all that a zip has; return their directory."""
    try:
        with ZipFile(file) as archive:
            parts = {PurePosixPath(one.filename): one for one in archive.infolist() if not one.is_dir()}
            fits = all(".." not in path.parts and one.file_size <= DOCUMENT_BYTES for path, one in parts.items())
            if not fits or sorted(path.name for path in parts) != [SPECIFICATION, WEIGHTS_FILE]:
                raise ValueError(short({str(path): one.file_size for path, one in parts.items()}))
            for path, one in parts.items():
                write_whole(output / path.name, archive.read(one))
    except (BadZipFile, zlib_error, RuntimeError, EOFError, OSError, ValueError) as error:
        expected = f"a zip of {SPECIFICATION} and {WEIGHTS_FILE}, of at most {DOCUMENT_BYTES} bytes each"
        raise ConfigurationError(f"{file}: expected {expected}, got {error}") from error
    return output


def _plugged(file: Path) -> str:
    """Run a plug-in and let the name of an entrant mean its decider; return that name."""
    print(f"{file}: code of others runs now, and may do whatever you may", file=sys.stderr)
    import_named(file)
    module = module_of(str(file.absolute()))
    classes = [one for one in vars(module).values() if isinstance(one, type) and issubclass(one, OptionDecider)]
    own: list[Any] = [one for one in classes if one.__module__ == module.__name__]
    if len(own) != 1:
        got = ", ".join(one.__name__ for one in own) or "none"
        raise ConfigurationError(f"{file}: expected one class below OptionDecider, got {got}")
    own[0].promises = {"_choose": ("the number of an option for each row", _are_options)}
    guard(own[0])
    DECIDERS[ENTRANT] = lambda text, *_: NamedDecider(text, own[0], further=tuple(getattr(own[0], "terms", ())))
    return f"{ENTRANT}:{file.name}"


def _are_options(decider: OptionDecider, answer: NDArray[Any], observations: Observations) -> bool:
    """Return whether an answer has the number of an option for each observation."""
    shaped = isinstance(answer, np.ndarray) and answer.shape == (len(observations),) and answer.dtype.kind in "iu"
    return shaped and bool(((answer >= 0) & (answer < len(decider.problem.options))).all())


def check_fits(file: Path, manifest: Manifest) -> None:
    """Raise ConfigurationError unless the entrant can decide in the first scenario of each family."""
    for family, compared in manifest.families.items():
        with within(f"{file}: {family}"):
            scenario = family_of(family, compared).scenario_named(manifest.seed, scenario_name("test", 0))
            goal, member = compared.goal or manifest.goal, manifest.strategies[ENTRANT]
            *_, decider = TrialTask(family, manifest.seed, (scenario,), ENTRANT, member, goal).team()
            decider.reset(np.arange(len(decider.teams)), 0)


if __name__ == "__main__":
    main(sys.argv[1:])

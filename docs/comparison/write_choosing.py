"""Judges strategies beside fixed options, and writes the tables of a page such as docs/choosing.md.

`python -m docs.comparison.write_choosing [--judge] [MANIFEST]`: MANIFEST is docs/comparison/choosing.yaml unless given.
Missions are kept in a file beside it, and what the file holds already is not done again; with `--judge` no mission is
done. Tables of a manifest without a page are printed.
"""

import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from clean_swarm_env.config.types import ConfigurationError
from docs.comparison.manifest import Manifest
from docs.comparison.missions import Missions, do_missions, read_missions
from docs.comparison.tables import Tables
from docs.figures.stored import ROOT, record
from selector.documents.errors import validated
from selector.documents.reading import read_mapping

OWN = Path(__file__).resolve().with_name("choosing.yaml")
COMMAND = "python -m docs.comparison.write_choosing"
JUDGE = "--judge"


def main(arguments: list[str]) -> int:
    """Make the tables; return 1 if something does not hold."""
    given, manifest, file, missions = asked_missions(arguments, OWN)
    tables = Tables(manifest, missions)
    if manifest.page:
        inputs = [*inputs_of(given, manifest.families), file.resolve().relative_to(ROOT).as_posix()]
        put_tables(manifest.name, tables.tables(), COMMAND, inputs)
    else:
        print("\n\n".join(tables.tables().values()))
    for claim in tables.claims.values():
        print(f"{claim.family}: {claim.strategy} / {claim.against} {claim.ratio:.3f}, p {claim.holm} (Holm)")
    for line in tables.broken():
        print(line)
    return 1 if tables.broken() else 0


def asked_missions(arguments: list[str], usual: Path) -> tuple[Path, Manifest, Path, Missions]:
    """Return file and manifest that are named, or the usual ones, and file and missions, of which none is missing."""
    named = [Path(word) for word in arguments if word != JUDGE]
    given = named[0] if named else usual
    manifest = validated(Manifest, read_mapping(given), str(given))
    file = given.with_suffix(".jsonl") if manifest.page else ROOT / "results" / manifest.name / "missions.jsonl"
    if JUDGE not in arguments:
        do_missions(manifest, file)
    missions = read_missions(file, manifest)
    asked = [(family, label) for family in manifest.families for label in manifest.run_on(family)]
    for family, label in asked:
        if (family, label) not in missions:
            raise ConfigurationError(f"{file}: expected missions of {label} on {family}, got none")
    return given, manifest, file, missions


def put_tables(name: str, tables: Mapping[str, str], command: str, inputs: Sequence[str]) -> None:
    """Record tables, each for its marks on the page of a name."""
    for mark, table in tables.items():
        record(f"{name}/{mark}", table, command, inputs)


def inputs_of(manifest: Path, families: Iterable[str]) -> list[str]:
    """Return the files that decide a comparison; they name all others."""
    shipped = [f"configs/families/{name}.yaml" for name in families]
    files = ["configs/robots/cleaning.yaml", *(name for name in shipped if (ROOT / name).exists())]
    return [manifest.resolve().relative_to(ROOT).as_posix(), *files]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

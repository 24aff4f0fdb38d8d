"""Whatever happened to a saved file, it is read as it was, or refused in one line that names it: never a traceback."""

import json
import shutil

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clean_swarm_env.config.mission import MissionConfig
from selector.documents.arrays import load_arrays, save_arrays
from selector.documents.errors import DocumentError, shown
from selector.documents.find import SHIPPED
from selector.strategies.learned_file import description_of, load_strategy
from selector.strategies.policy_file import load_policy
from selector.strategies.problem import Problem
from selector.strategies.streams import row_keys
from tests.attacks import hostile
from tests.train.records import record
from train.evaluation.repeat import changed_versions, chosen_options, task_of
from train.running.finished_runs import JOURNAL, Results
from train.running.run_folder import CHOSEN_OPTIONS, MANIFEST, RunFolder, read_manifest

RULES = SHIPPED / "strategies" / "rules.safetensors"
POLICY = SHIPPED / "policies" / "general"
often = settings(
    max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture]
)
ODD = st.sampled_from([np.nan, np.inf, -np.inf, -1e300, 1e300, -1.0])


def damaged(content: bytes):
    """Bytes of a file of which a part was changed, lost or doubled."""
    places = st.integers(0, len(content) - 1)
    return (
        st.builds(lambda k, byte: content[:k] + bytes([byte]) + content[k + 1 :], places, st.integers(0, 255))
        | places.map(lambda k: content[:k])
        | st.builds(lambda a, b: content[: min(a, b)] + content[max(a, b) :], places, places)
        | st.builds(lambda k, more: content[:k] + more + content[k:], places, st.binary(min_size=1, max_size=20))
    )


def read_or_refused(read, path, named=None):
    """Return what `read` returns; None if it refuses a path in one line with its name, or with `named`."""
    message = ""
    try:
        return read(path)
    except DocumentError as error:
        message = str(error)
    assert (named or shown(path)) in message
    assert len(message.splitlines()) == 1
    return None


def read_strategy(path):
    described = description_of(path)
    try:
        problem = Problem(described.goal, described.options, np.zeros(len(described.options)), described.features)
        strategy = described.spec.build(problem, row_keys(np.random.SeedSequence(0), 1), np.zeros(1, dtype=np.int64))
    except ValueError as error:  # as a comparison says it, which has a problem of its own
        raise DocumentError(f"{shown(path)}: {error}") from error
    load_strategy(path, strategy)
    return strategy


@often
@given(damaged(RULES.read_bytes()))
def test_damaged_files_of_strategies(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "damaged.safetensors"
    path.write_bytes(content)
    strategy = read_or_refused(read_strategy, path)
    if strategy is not None:
        assert all(np.isfinite(array).all() for array in strategy.learned().values())


def test_strategies_of_odd_descriptions(tmp_path):
    arrays, description = load_arrays(RULES)
    path = tmp_path / "odd.safetensors"

    @often
    @given(hostile.json_documents(description))
    def attack(text):
        try:
            odd = json.loads(text)
        except (ValueError, RecursionError):
            return
        save_arrays(path, arrays, odd)
        read_or_refused(read_strategy, path)

    attack()


@pytest.mark.parametrize("number", [np.nan, np.inf, -1e300])
def test_odd_numbers_in_a_strategy_are_refused(tmp_path, number):
    arrays, description = load_arrays(RULES)
    for name, array in arrays.items():
        changed = array.copy()
        changed.flat[0] = number
        save_arrays(tmp_path / "odd.safetensors", arrays | {name: changed}, description)
        with pytest.raises(DocumentError, match=rf"odd\.safetensors: state '{name}': expected"):
            read_strategy(tmp_path / "odd.safetensors")


def test_a_strategy_of_a_newer_release_says_so(tmp_path):
    arrays, description = load_arrays(RULES)
    path = tmp_path / "newer.safetensors"
    for change in ({"strategy": "Future"}, {"parameters": description["parameters"] | {"future": 1.0}}):
        save_arrays(path, arrays, description | change)
        with pytest.raises(DocumentError, match=r"newer\.safetensors: .*unknown .*newer release may have written it"):
            description_of(path)


@pytest.mark.parametrize("name", ["policy.json", "policy.safetensors"])
def test_damaged_policies(tmp_path, name):
    shutil.copytree(POLICY, tmp_path / "policy")
    whole = (POLICY / name).read_bytes()

    @often
    @given(damaged(whole))
    def attack(content):
        (tmp_path / "policy" / name).write_bytes(content)
        read_or_refused(load_policy, tmp_path / "policy")

    attack()


def test_policies_of_odd_values(tmp_path):
    shutil.copytree(POLICY, tmp_path / "policy")
    content = json.loads((POLICY / "policy.json").read_text())

    @often
    @given(hostile.json_documents(content))
    def attack(text):
        path = hostile.write(tmp_path / "policy", "policy.json", text)
        read_or_refused(lambda path: load_policy(path.parent), path.parent)

    attack()


def asked(kept):
    return kept.mistake("x", 3, MissionConfig())


def journal(directory, text):
    """Return the runs that are kept in a journal, as `--resume` of the evaluation "x" of seed 3 reads them."""
    folder = RunFolder(directory, {"identity": {"experiment": "x"}}, resume=True)
    (directory / JOURNAL).write_bytes(text)
    return read_or_refused(lambda _: Results(folder, asked).records, directory / JOURNAL)


LINES = "".join(json.dumps(record(name, "a").as_mapping()) + "\n" for name in ("1", "2", "3")).encode()


@often
@given(damaged(LINES))
def test_damaged_journals(tmp_path_factory, content):
    records = journal(tmp_path_factory.mktemp("journal"), content)
    for kept in records or ():
        assert (kept.experiment, kept.seed) == ("x", 3)
        assert 0.0 <= kept.result.duration_s <= 3000.0


@often
@given(hostile.json_documents(record("1", "a").as_mapping()))
def test_journals_of_odd_values(tmp_path_factory, text):
    line = text.encode("utf-8", errors="surrogatepass") + b"\n"
    records = journal(tmp_path_factory.mktemp("journal"), line)
    assert all(np.isfinite(kept.result.cost_s) for kept in records or ())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"experiment": "y"}, "experiment: expected x, got y"),
        ({"seed": 4}, "seed: expected 3, got 4"),
        ({"seed": True}, "seed"),
        ({"duration_s": 3001.0}, "duration_s: expected at most 3000"),
        ({"duration_s": "Infinity"}, "duration_s"),
        ({"duration_s": -1e300}, "duration_s: expected a number from 0"),
        ({"completed": 1}, "completed"),
        ({"robots": 6}, "robots: expected at most 5"),
        ({"collision_samples_per_s": [1.0]}, "collision_samples_per_s: expected 2 numbers"),
        ({"more": 1}, "expected the keys"),
    ],
)
def test_runs_that_were_not_asked_for_are_refused(tmp_path, changes, message):
    folder = RunFolder(tmp_path / "r", {"identity": {"experiment": "x"}}, resume=False)
    Results(folder, asked).add(record("1", "a"))
    line = json.dumps(record("2", "a").as_mapping() | changes) + "\n"
    (folder.path / JOURNAL).write_text((folder.path / JOURNAL).read_text() + line)
    before = (folder.path / JOURNAL).read_bytes()
    with pytest.raises(DocumentError, match=rf"r/runs\.jsonl: line 2: .*{message}"):
        Results(folder, asked)
    assert (folder.path / JOURNAL).read_bytes() == before


def test_a_run_that_is_kept_twice_is_refused(tmp_path):
    folder = RunFolder(tmp_path / "r", {"identity": {"experiment": "x"}}, resume=False)
    (folder.path / JOURNAL).write_bytes(LINES + LINES)
    with pytest.raises(DocumentError, match=r"line 4: scenario 1, condition a: is there twice"):
        Results(folder, asked)


@pytest.mark.parametrize("odd", [1, "x", [], {"G": 1}, {"G": {"a": 1}}, {"G": {"a": {"count": -1}}}, None])
def test_what_a_manifest_says_was_learned_is_checked(tmp_path, odd):
    content = {"identity": {"experiment": "x"}, "learned": odd}
    (tmp_path / MANIFEST).write_text(json.dumps(content))
    for read in (read_manifest, lambda path: RunFolder(path, {"identity": {"experiment": "x"}}, resume=True)):
        with pytest.raises(DocumentError, match=r"manifest\.json: learned(\.G)?(\.a)?(: count)?.*expected") as error:
            read(tmp_path)
        assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize("line", ["{", "[]", '{"scenario": 1}', '{"scenario": "1", "condition": "a", "options": [1]}'])
def test_damaged_choices_of_a_learning_evaluation_are_one_line(tmp_path, line):
    (tmp_path / CHOSEN_OPTIONS).write_text(line + "\n")
    with pytest.raises(DocumentError, match=rf"{CHOSEN_OPTIONS}: line 1: ") as error:
        chosen_options(tmp_path)
    assert len(str(error.value).splitlines()) == 1


def test_odd_manifests(tmp_path):
    identity = {"experiment": "x", "seed": 1, "configuration": {"name": "x"}, "files": {}, "directories": []}
    learned = {"G": {"a": {"count": 3, "mean": 0.5, "variance": 0.0}}}
    content = {"identity": identity, "versions": {"numba": "1"}, "learned": learned}

    @often
    @given(hostile.json_documents(content))
    def attack(text):
        path = hostile.write(tmp_path, MANIFEST, text)
        for read in (lambda path: read_manifest(path.parent), lambda path: changed_versions(path.parent)):
            read_or_refused(read, path)
        read_or_refused(lambda path: task_of(path.parent), path)

    attack()

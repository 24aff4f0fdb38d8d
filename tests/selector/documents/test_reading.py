"""The one reader of documents: YAML 1.2's core schema, limits, and errors with file, line and key."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from selector.documents.errors import DocumentError, validated
from selector.documents.fields import Closed, DocumentName, Name, NonNegative, Positive, Share
from selector.documents.reading import as_yaml, read_json, read_mapping, read_value
from selector.documents.yaml_values import MOST_DEPTH, MOST_NODES

PLAIN = {text: text for text in ("Off", "No", "y", "2024-13-45", "12:30:45", "1_000")}
PLAIN |= {"true": True, "FALSE": False, "null": None, "~": None, "": None, "'1'": "1", '"null"': "null"}
PLAIN |= {"0o17": 15, "0x1F": 31, "017": 17, "-3": -3, "1e-9": 1e-9, ".5": 0.5, "1.": 1.0, "-.inf": float("-inf")}


@pytest.mark.parametrize("text", PLAIN)
def test_plain_values_are_read_by_the_core_schema(text):
    value = read_value(text)
    assert (value, type(value)) == (PLAIN[text], type(PLAIN[text]))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: {[1]: 2}", r"line 1: a: expected text as a key, got \[1\]"),
        ("a: {1: 2}", "line 1: a: expected text as a key, got 1"),
        ("a: " + "1" * 5000, "line 1: a: expected a whole number of at most 40 digits, got 5000"),
        ("a: !!float ''", "line 1: a: expected a value without a tag"),
        ("a: !!bool x", "without a tag"),
        ("a: !!timestamp x", "without a tag"),
        ("a: !!map abc", "without a tag"),
        ("a: .nan", "line 1: a: expected a number, got .nan"),
        ("a: 1e999", "line 1: a: expected a number, got 1e999"),
        ("a: " + "[" * 60 + "]" * 60, f"line 1: a.*: expected values in at most {MOST_DEPTH} others"),
        ("a: " + "[" * 3000 + "]" * 3000, f"line 1: .*expected values in at most {MOST_DEPTH} others"),
        ("a: &b [*b]", r"line 1: a\.0: expected an alias of a whole value above, got \*b"),
        ("a: *b", r"line 1: a: expected an alias of a whole value above, got \*b"),
        ("a: [1, *None]", r"line 1: a\.1: expected an alias of a whole value above, got \*None"),
        ("a: &b 1\nc: &b [*b]", r"line 2: c\.0: expected an alias of a whole value above, got \*b"),
        ("[" + "[]," * (MOST_NODES - 1) + "]", "expected a mapping of keys, got list"),
        ("a: 1\nb:\n  c: 1\n  c: 2", "line 4: b: key 'c' twice"),
        ("a: 1\n---\nb: 2", "line 2: expected one document"),
        ("a: [" + ",".join(["1"] * MOST_NODES) + "]", f"line 1: a.*: expected at most {MOST_NODES} values"),
        ("- 1", "expected a mapping of keys, got list"),
        ("", "expected a mapping of keys, got NoneType"),
    ],
)
def test_what_cannot_be_used_is_named_by_file_line_and_key(tmp_path, text, expected):
    (tmp_path / "x.yaml").write_text(text)
    with pytest.raises(DocumentError, match=rf"x\.yaml: {expected}" if expected[0] in "le" else expected):
        read_mapping(tmp_path / "x.yaml")


def test_aliases_count_wherever_they_stand_and_mean_the_last_value_before_them(tmp_path):
    lines = ["a0: &a0 [1,1,1,1,1,1,1,1,1,1]"]
    lines += [f"a{k}: &a{k} [{','.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 6)]
    (tmp_path / "few.yaml").write_text("\n".join(lines[:4]))
    assert sum(read_mapping(tmp_path / "few.yaml")["a1"][3]) == 10
    assert read_value("[&a [&b 1, *b], &b 2, *a, *b]") == [[1, 1], 2, [1, 1], 2]
    (tmp_path / "many.yaml").write_text("\n".join(lines))
    with pytest.raises(
        DocumentError, match=r"many\.yaml: line \d: a4\.\d[.\d]*: expected at most 50000 values, with those"
    ):
        read_mapping(tmp_path / "many.yaml")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"a": [1, NaN]}', r"a\.1: expected a finite number, got nan"),
        ('{"a": {"b": -Infinity}}', r"a\.b: expected a finite number, got -inf"),
        ('{"a": 1, "a": 2}', "key 'a' twice"),
        ('{"a": ' + "[" * 5000 + "]" * 5000 + "}", r"(a[.0]*: )?expected values in at most"),
        ('{"a": ' + "9" * 5000 + "}", "expected a whole number of at most 40 digits"),
        ('{"a": ', "line 1: .*expected JSON"),
    ],
)
def test_json_has_the_same_limits(tmp_path, text, expected):
    (tmp_path / "x.json").write_text(text)
    with pytest.raises(DocumentError, match=rf"x\.json: {expected}"):
        read_json(tmp_path / "x.json")


@given(st.text() | st.sampled_from([*PLAIN, "0o7", "+1", "1E5", "<<", "=", "%", "@a", "\x85", "a: b"]))
def test_text_is_written_so_that_it_is_read_back(text):
    assert read_value(as_yaml({"a": text, "b": [text]})) == {"a": text, "b": [text]}


class Named(Closed):
    """A document with both kinds of names."""

    name: Name = "x"
    other: DocumentName = "x"


class Numbers(Closed):
    """Numbers of each kind."""

    at_least_zero: NonNegative = 0.0
    positive: Positive = 1.0
    share: Share = 0.0


@pytest.mark.parametrize(
    ("key", "low", "high"), [("at_least_zero", 0.0, 1e9), ("positive", 1e-9, 1e9), ("share", 0.0, 1.0)]
)
def test_numbers_lie_between_their_limits_and_may_equal_them(key, low, high):
    for number in (low, 0.5 * (low + high), high):
        assert getattr(validated(Numbers, {key: number}, "x"), key) == number
    for number in (np.nextafter(low, -1.0), np.nextafter(high, np.inf)):
        with pytest.raises(DocumentError, match=f"^x: {key}: "):
            validated(Numbers, {key: float(number)}, "x")


@pytest.mark.parametrize("name", ["table1", "a b", "Größe_2-1.5", "x" * 100, "1"])
def test_names_are_letters_digits_and_a_few_signs(name):
    assert validated(Named, {"name": name, "other": name}, "x").name == name


@pytest.mark.parametrize(
    "name", ["", "..", "../x", "a/b", "a\0b", "[b]", "=1", "-x", "@x", "a\nb", "x ", ".x", "x" * 101, "\ud800", "a:b"]
)
def test_other_names_are_refused(name):
    for key in ("name", "other"):
        with pytest.raises(DocumentError, match=rf"^x: {key}: "):
            validated(Named, {key: name}, "x")


def test_a_document_may_be_named_by_its_absolute_path():
    assert validated(Named, {"other": "/home/me/x.yaml"}, "x").other == "/home/me/x.yaml"
    with pytest.raises(DocumentError, match=r"^x: other: expected printable characters"):
        validated(Named, {"other": "/home/\x1b[31m"}, "x")


def test_errors_are_plain_text_on_one_line_whatever_they_quote():
    error = DocumentError("a\nb\x1b[31m\ud800" + "y" * 10_000)
    assert str(error).startswith("a b\\x1b[31m\\ud800yyy")
    assert str(error).isprintable()
    assert len(str(error)) < 2000

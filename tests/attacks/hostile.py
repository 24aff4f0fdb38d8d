"""Documents of every kind, of which one value or name was replaced by something hostile, drawn at random."""

import json
from functools import cache

import yaml
from hypothesis import strategies as st

from tests.paths import ROOT

MARK = "REPLACED-HERE"


@cache
def shipped(kind: str) -> list[dict]:
    paths = sorted((ROOT / "configs" / kind).glob("*.yaml"))
    assert paths
    return [yaml.safe_load(path.read_text(encoding="utf-8")) for path in paths]


def places(content, here=()):
    """Yield the keys that lead to every value below a document."""
    items = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, below in items:
        yield (*here, key)
        yield from places(below, (*here, key))


def replaced(content, place, value):
    """Return a copy of a document with `value` at a place."""
    if not place:
        return value
    copy = dict(content) if isinstance(content, dict) else list(content)
    copy[place[0]] = replaced(content[place[0]], place[1:], value)
    return copy


def bomb(levels, width, leaf):
    parts = [f"&a0 [{','.join([leaf] * width)}]"]
    parts += [f"&a{k} [{','.join([f'*a{k - 1}'] * width)}]" for k in range(1, levels)]
    return f"[{', '.join(parts)}]"


names = (
    st.sampled_from(
        [
            "../../x",
            "/etc/passwd",
            "a/b",
            "a\0b",
            "x" * 300,
            "[bold]x[/bold]",
            "[/x]",
            "=1+1",
            "@a",
            "\x1b[31mred",
            "a\nb",
        ]
    )
    | st.sampled_from(["..", "-x", "", " ", "~", "Ⅳ" * 101, "null", "1e999", "0x10", "2024-13-45", "Off"])
    | st.text(max_size=200)
)
numbers = (
    st.sampled_from([0, -1, 1e300, -1e300, 1e-300, 10**9, 10**30, 2**63, 2**64 - 1, 1e9 + 1, 5e-324, True, 10**8])
    | st.integers(-(10**40), 10**40)
    | st.floats(allow_nan=False, allow_infinity=False)
)
plain_values = st.recursive(
    st.none() | st.booleans() | numbers | names,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(names, inner, max_size=4),
    max_leaves=8,
)
texts = (
    st.builds(bomb, st.integers(2, 12), st.integers(2, 12), st.sampled_from(["lol", "1", "{a: 1}", "[]"]))
    | st.sampled_from(["!!float ''", "!!bool x", "!!timestamp x", "!!map abc", "!!python/object:os.system x", "! x"])
    | st.sampled_from(["{[1]: 2}", "{? {a: 1} : 2}", "&a [*a]", "&a {b: *a}", "*nowhere", ".nan", ".inf", "-.inf"])
    | st.integers(41, 6000).map(lambda digits: "7" * digits)
    | st.integers(51, 5000).map(lambda depth: "[" * depth + "]" * depth)
    | st.integers(51, 2000).map(lambda depth: "{a: " * depth + "1" + "}" * depth)
    | st.integers(51, 2000).map(lambda depth: "{type: Negation, of: " * depth + "x" + "}" * depth)
    | st.sampled_from(['"\\ud800"', '"\\0"', "2024-13-45", "1e999", "{a: 1, a: 2}", "a: b: c", "]", "\t- a", "%YAML 9"])
)


def in_yaml(value, **options):
    return yaml.dump(value, Dumper=yaml.CSafeDumper, sort_keys=False, **options)


@cache
def marked(kind):
    """Return the texts of all documents of a kind with a mark in place of each value; made once, for it takes long."""
    return [
        in_yaml(replaced(content, place, MARK), default_flow_style=True, width=10**9)
        for content in shipped(kind)
        for place in places(content)
    ]


@st.composite
def documents(draw, kind):
    """Text of a document of a kind in YAML, with one hostile value, or one more or another key."""
    if draw(st.integers(0, 9)) == 0:
        content = draw(st.sampled_from(shipped(kind)))
        place = draw(st.sampled_from(list(places(content))))
        return in_yaml(replaced(content, place, draw(plain_values)))
    return draw(st.sampled_from(marked(kind))).replace(MARK, draw(texts | numbers.map(repr) | names.map(json.dumps)), 1)


def json_documents(content):
    """Texts of a document in JSON, with one hostile value."""
    texts_with_a_mark = [json.dumps(replaced(content, place, MARK)) for place in places(content)]
    values = (
        (plain_values | numbers).map(json.dumps)
        | st.sampled_from(["NaN", "Infinity", "-Infinity", "1e999", '{"a":1,"a":2}', '"\\ud800"', "[", "7" * 5000])
        | st.integers(51, 5000).map(lambda depth: "[" * depth + "]" * depth)
    )
    return st.builds(
        lambda text, value: text.replace(f'"{MARK}"', value, 1), st.sampled_from(texts_with_a_mark), values
    )

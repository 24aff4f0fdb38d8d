"""The structure keeps its rules: no circles of imports, small folders, names with one meaning, short signatures."""

import ast

import pytest

from tests import house
from tests.house import MOST_MODULES

ELEMENTARY = {
    "sin",
    "cos",
    "tan",
    "arcsin",
    "arccos",
    "arctan",
    "arctan2",
    "atan2",
    "exp",
    "expm1",
    "log",
    "log1p",
    "log2",
    "log10",
    "tanh",
    "hypot",
    "power",
}
"""Functions whose last bits differ between CPUs; `selforg.elementary` has those that a course needs."""
LOOKING = ("clean_swarm_env.drawing", "clean_swarm_env.tasks.measures")
"""Packages that look at a course and change nothing in it."""


def test_no_modules_import_each_other_in_a_circle():
    assert house.circle() == []


def test_a_folder_holds_no_more_modules_than_can_be_overlooked():
    folders = house.modules_in_folders(packages=(*house.PACKAGES, "tests"))
    assert {folder: n for folder, n in folders.items() if n > MOST_MODULES} == {}


def test_a_public_name_has_one_meaning_across_the_packages():
    assert house.names_defined_twice() == {}


def test_no_name_of_a_function_or_field_has_a_word_that_meant_too_much():
    assert house.retired_names() == {}


def test_signatures_are_short():
    assert house.long_signatures() == []


def test_a_course_takes_no_functions_whose_bits_differ_between_cpus():
    taken = []
    for name, tree in house.sources().items():
        if name.startswith(("train", *LOOKING)):
            continue
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in ("np", "math"):
                taken += [(name, node.attr)] if node.attr in ELEMENTARY else []
            elif isinstance(node, ast.ImportFrom) and node.module in ("math", "numpy"):
                taken += [(name, alias.name) for alias in node.names if alias.name in ELEMENTARY]
    assert taken == []


@pytest.fixture
def package(tmp_path):
    """An empty package in a checkout of its own."""
    (tmp_path / "selforg").mkdir()
    (tmp_path / "selforg" / "__init__.py").touch()
    return tmp_path / "selforg"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("import b", ["a", "b"]),
        ("def f():\n    from pkg import b\n", ["a", "b"]),
        ("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import b\n", ["a", "b"]),
        ("import os", []),
    ],
)
def test_hidden_circles_are_found(package, text, found):
    (package / "a.py").write_text(
        text.replace("import b", "import selforg.b").replace("from pkg import selforg.b", "from selforg import b")
    )
    (package / "b.py").write_text("import selforg.a\n")
    assert house.circle(package.parent) == [f"selforg.{name}" for name in found]


def test_retired_names_are_found(package):
    (package / "a.py").write_text(
        "class A:\n    told: int\n    tolds: int\n    def _begin(self): ...\ndef a_begin(): ...\ndef beginning(): ...\n"
    )
    assert set(house.retired_names(package.parent)) == {"selforg.a.A._begin", "selforg.a.A.told", "selforg.a.a_begin"}

import ast

import pytest

from tests.mutants.drawing import UNCOMPILED, draw, faults, mutants_of, nearest_tests
from tests.mutants.mutant import Mutant, noticed
from tests.paths import ROOT


def changes(source):
    return [ast.unparse(other) for _, other in faults(ast.parse(source))]


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("a + b", ["a - b"]),
        ("a += b", ["a -= b"]),
        ("a < b <= c", ["a <= b <= c", "a < b < c"]),
        ("a and b", ["a or b"]),
        ("not a", ["a"]),
        ("a.shape[1]", ["2"]),
        ("f(True, 0.5)", ["False", "1.5"]),
        ("zip(a, b, strict=True)", []),
        ("'a text' f'{a + 1}'", []),
        ("a: Literal[1] = b", []),
        ("def f(a: Literal[1]) -> Literal[1]:\n    'What.'\n    raise ValueError(a + 1)", []),
        ("@kernel(1)\nclass A(B[1]):\n    'What.'", []),
    ],
)
def test_what_may_be_another(source, found):
    assert changes(source) == found


def test_a_draw_depends_on_its_seed_only_and_every_file_that_it_makes_can_be_read():
    drawn = draw(200, 1)
    assert drawn == draw(200, 1)
    assert drawn != draw(200, 2)
    assert len({(mutant.file, mutant.start, mutant.after) for mutant in drawn}) == 200
    for mutant in drawn:
        whole = (ROOT / mutant.file).read_text()
        assert ast.dump(ast.parse(mutant.applied(whole))) != ast.dump(ast.parse(whole))


def test_only_the_text_of_the_fault_changes_beside_letters_of_several_bytes(tmp_path):
    (tmp_path / "tests" / "selforg").mkdir(parents=True)
    (tmp_path / "tests" / "selforg" / "test_a.py").touch()
    (tmp_path / "selforg").mkdir()
    (tmp_path / "selforg" / "a.py").write_text("é = 'ü'; b = c  # é\nd = ('ü', b + c)\n", encoding="utf-8")
    (found,) = mutants_of("selforg/a.py", tmp_path)
    assert found.applied("é = 'ü'; b = c  # é\nd = ('ü', b + c)\n") == "é = 'ü'; b = c  # é\nd = ('ü', (b - c))\n"


def test_the_tests_of_the_own_folder_are_taken_the_namesake_first():
    assert nearest_tests("selforg/gradients/delivery.py")[0] == "tests/selforg/gradients/test_delivery.py"
    assert "tests/selforg/gradients/test_delivery.py" in nearest_tests("selforg/gradients/store/linking.py")
    step = "selforg/network/step"
    assert nearest_tests(f"{step}/plan_monitoring.py") == (f"tests/{step}/test_plan_monitoring.py",)
    assert all((ROOT / folder).is_dir() and (ROOT / "tests" / folder).is_dir() for folder in UNCOMPILED)


A_TEST = """
import pytest
from b import a

@pytest.mark.parametrize("letter", ["x y"])
def test_a(letter):
    assert a == 1

@pytest.mark.long
def test_what_the_gate_leaves_out():
    assert a == 0
"""
CONFIGURED = "[tool.pytest.ini_options]\naddopts = \"-m 'not long'\"\nmarkers = ['long: what takes long']\n"


@pytest.mark.parametrize(
    ("fault", "by"),
    [
        ("a + 1", "tests/selforg/test_a.py::test_a"),
        pytest.param("", "tests/selforg/test_a.py", marks=pytest.mark.long),
        pytest.param("a", "", marks=pytest.mark.long),
    ],
)
def test_the_test_that_fails_is_named(tmp_path, fault, by):
    (tmp_path / "tests" / "selforg").mkdir(parents=True)
    (tmp_path / "tests" / "selforg" / "test_a.py").write_text(A_TEST)
    (tmp_path / "pyproject.toml").write_text(CONFIGURED)
    (tmp_path / "b.py").write_text("a = 1\na = a\n")
    assert noticed(Mutant("a name", "b.py", "a = a", f"a = {fault}", ("tests/selforg/test_a.py",), 6), tmp_path) == by
    assert (tmp_path / "b.py").read_text() == "a = 1\na = a\n"

"""The names that users import from the package, and that importing the package itself costs nothing."""

import ast
import subprocess
import sys

import pytest

import clean_swarm_env
from tests.paths import ROOT

NAMES = {
    "ActionConfig", "Batch", "ConfigurationError", "FamilyConfig", "MissionConfig", "ObservationConfig", "RewardConfig",
    "StartConfiguration", "TERMS", "Term", "batches_of", "load_family", "load_mission", "mission_begun", "run_out",
}  # fmt: skip
SOURCE = (ROOT / "clean_swarm_env" / "__init__.py").read_text(encoding="utf-8")


def test_the_public_names_are_these():
    assert set(clean_swarm_env.MODULE_OF) == NAMES


@pytest.mark.parametrize("name", sorted(NAMES))
def test_a_public_name_is_what_its_module_defines(name):
    value = getattr(clean_swarm_env, name)
    assert getattr(value, "__module__", "").startswith(("clean_swarm_env.", "selector.", "selforg."))


def test_type_checkers_see_the_same_names_at_the_same_places():
    imports = [node for node in ast.walk(ast.parse(SOURCE)) if isinstance(node, ast.ImportFrom)]
    seen = {
        alias.name: node.module.removeprefix("clean_swarm_env.")
        for node in imports
        if node.module.startswith("clean_swarm_env.")
        for alias in node.names
    }
    assert seen == clean_swarm_env.MODULE_OF


def test_importing_the_package_imports_nothing_else():
    code = "import sys, clean_swarm_env; print(*sys.modules)"
    loaded = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert not {"numpy", "numba", "pymunk", "pydantic", "matplotlib"} & set(loaded.split())

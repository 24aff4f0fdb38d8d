"""What docs/exploring.md shows works, and its tables name all that ships."""

import re

from clean_swarm_env.config.load import load_family
from selector.knowledge import load_knowledge
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "exploring.md").read_text(encoding="utf-8")


def named(heading):
    """Return the first column of the table below a heading."""
    part = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    return re.findall(r"^\| `([\w-]+)` \|", part, flags=re.MULTILINE)


def test_the_example_runs(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    exec(compile(example, "exploring.md", "exec"), {})
    assert capsys.readouterr().out.count("30 items, spots:") == 3


def test_the_tables_name_all_options_and_families():
    assert set(named("Ways to explore")) == {o.name for o in load_knowledge("exploring").options("ExplorationPatrol")}
    for name in named("Families"):
        family = load_family(name)
        assert family.mission.knowledge == "exploring"
        if name != "crowded-exploring":
            assert family.spots == (0, 1)
            kinds = [len(family.scenario(1, k, "test").mission.task.garbage.spots) for k in range(100)]
            assert 35 <= sum(kinds) <= 65
    assert named("Families") == ["clustered", "hotspots", "rare", "crowded-exploring", "unseen-exploring"]

"""What docs/transport.md shows works, and its tables name all that ships."""

import re

from selector.knowledge import load_knowledge
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "transport.md").read_text(encoding="utf-8")


def test_the_example_runs(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    exec(compile(example, "transport.md", "exec"), {})
    assert capsys.readouterr().out == "6 stations, kinds: (0, 1, 0, 0, 1, 1)\n"


def test_the_table_names_all_options():
    part = PAGE.partition("## Ways to carry\n")[2].partition("\n## ")[0]
    named = re.findall(r"^\| `([\w-]+)` \|", part, flags=re.MULTILINE)
    assert named == [option.name for option in load_knowledge("transport").options("Transport")]

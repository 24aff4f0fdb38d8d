"""Makes the docstrings of this repository, which are Markdown with sections as Google has them, reStructuredText."""

import re

CODE = re.compile(r"(?<!`)`([^`\n]+)`(?!`)")
ENTRY = re.compile(r"[\w, ]+: \S")


def converted(lines: list[str]) -> list[str]:
    """Return the lines of a docstring as Sphinx reads them: code, lists of fields, and no emphasis."""
    result: list[str] = []
    for block in blocks(lines):
        code = block[0].startswith("    ") and not block[0].lstrip().startswith((">>>", "-"))
        if code:
            result += ["::", "", *block]
        elif ENTRY.match(block[0]) and any(line.startswith("    ") for line in block):
            result += [f"  {plain(line.strip())}" if line.startswith("    ") else f"- {plain(line)}" for line in block]
        else:
            result += [line if ">>>" in block[0] else plain(line) for line in block]
        result.append("")
    return result


def blocks(lines: list[str]) -> list[list[str]]:
    """Return the paragraphs; code with empty lines inside is one."""
    found: list[list[str]] = []
    gap = True
    for line in lines:
        inside = found and found[-1][0].startswith("    ") and line.startswith("    ")
        if line.strip() and gap and inside:
            found[-1] += ["", line]
        elif line.strip() and gap:
            found.append([line])
        elif line.strip():
            found[-1].append(line)
        gap = not line.strip()
    return found


def plain(line: str) -> str:
    """Return a line whose code is marked as reStructuredText does, and whose stars are stars."""
    parts = re.split(r"(``[^`]+``)", CODE.sub(r"``\1``", line))
    return "".join(part if part.startswith("``") else re.sub(r"(?<!\\)\*", r"\\*", part) for part in parts)

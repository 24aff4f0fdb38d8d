"""Settings of Sphinx for the site; `make docs` builds it."""

from typing import Any

from docs.site.docstrings import converted

project = "Clean Swarm"
author = "The Clean Swarm developers"
copyright = author
language = "en"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
suppress_warnings = ["ref.python"]  # several classes have fields of one name; such a name links to the first

# pages
myst_enable_extensions = ["attrs_block"]
myst_heading_anchors = 4  # links to headings, as GitHub makes them

# API
autodoc_mock_imports = ["stable_baselines3", "torch", "rosbags"]  # the site needs no extra but its own
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
napoleon_use_ivar = True  # attributes of classes are listed in their docstrings
napoleon_google_docstring, napoleon_numpy_docstring = True, False

# looks; fonts are those of the reader's system, and no page loads anything from elsewhere
html_theme = "furo"
html_title = project
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["search.js"]
html_copy_source = False
html_show_sourcelink = False


def setup(app: Any) -> None:  # noqa: ANN401  (the application of Sphinx)
    """Have docstrings converted before Napoleon reads their sections."""

    def convert(_app: object, _what: str, _name: str, _value: object, _options: object, lines: list[str]) -> None:
        lines[:] = converted(lines)

    app.connect("autodoc-process-docstring", convert, priority=100)

"""Settings of the documentation site: `make docs` builds it into build/docs-site.

The source folder is the whole repository, so that links between pages lead to the same files on the site and
on a code host.
"""

from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

ROOT = Path(__file__).parents[1]

project = "Nocturne"
root_doc = "docs/index"
include_patterns = [
    "docs/**",
    "examples/*/README.md",
    "bench/README.md",
    "bench/suite/README.md",
    "coordinator/README.md",
    "tests/corpus/README.md",
    "tests/faults/README.md",
    "tests/mitsuba/README.md",
    "tests/stability/README.md",
    "worker/README.md",
    "services/web/README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
]
exclude_patterns = [".*", "build", "data", "**/node_modules"]
extensions = ["myst_parser", "sphinx.ext.autodoc"]

# Anchors as code hosts make them, down to the fourth level.
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]

# Docstrings have code between single backticks.
default_role = "code"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_class_signature = "mixed"

html_theme = "furo"
html_title = "Nocturne"
html_show_sourcelink = False
html_show_copyright = False
html_extra_path = ["site"]
templates_path: list[str] = []


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.connect("doctree-read", _folders_as_text)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _folders_as_text(app: Sphinx, document: nodes.document) -> None:
    """Links to folders of the repository keep their text: a site has no page for a folder."""
    page = Path(app.env.doc2path(app.env.docname)).parent
    for link in list(document.findall(lambda node: "reftarget" in getattr(node, "attributes", {}))):
        target = ROOT / page / str(link["reftarget"])
        if target.is_dir():
            link.replace_self(link.children)

"""Sphinx configuration of the documentation site: `make docs` builds it into docs/_build/html."""

from __future__ import annotations

import sys
from importlib.metadata import version as installed_version
from pathlib import Path

project = "SCOPE"
author = "The SCOPE authors"
project_copyright = "The SCOPE authors"
release = version = installed_version("scope-ptz")

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

extensions = [
    "command_help",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
root_doc = "index"
nitpicky = False  # types of third-party packages have no inventory offline

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4

autodoc_member_order = "groupwise"
autodoc_typehints = "signature"
python_maximum_signature_line_length = 88
autodoc_default_options = {"exclude-members": "model_config"}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True

html_theme = "furo"
html_title = f"SCOPE {release}"
html_theme_options = {
    "navigation_with_keys": True,
    # Help texts are 96 characters wide: this size fits them into a page.
    "light_css_variables": {"code-font-size": "12px"},
}
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True
copybutton_line_continuation_character = "\\"

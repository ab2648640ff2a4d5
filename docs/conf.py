"""The site's settings for Sphinx; `./run docs` builds it."""

import sys
from pathlib import Path

DOCS = Path(__file__).parent
sys.path[:0] = [str(DOCS.parent), str(DOCS / "extensions")]

import contactdd  # noqa: E402

project, author, version = "contactdd", "The contactdd authors", contactdd.__version__
release, copyright = version, author
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "mathml",
    "demos",
    "google",
    "notebooks",
]
exclude_patterns = ["conf.py", "extensions"]

# Text
myst_enable_extensions = ["dollarmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
html_math_renderer = "mathml"
default_role = "py:obj"  # in docstrings: a link where it names something, else code

# Notebooks: the how-to pages run when they are built; demos, which take longer, do not.
nb_custom_formats = {".py": "demos.notebook"}
nb_execution_mode = "auto"
nb_execution_excludepatterns = ["demos/*.py"]
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_merge_streams = True
nb_ipywidgets_js = {}  # they would come from elsewhere

# Reference
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings say what parameters are, in words

# Pages without anything from elsewhere
html_theme = "furo"
html_title = f"contactdd {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
copybutton_exclude = ".linenos, .gp, .go"
suppress_warnings = ["mystnb.unknown_mime_type"]

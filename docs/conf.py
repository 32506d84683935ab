"""The book: Markdown to HTML that needs no network, with every warning an error (`docs/build`)."""

import importlib.util
import sys
import tomllib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "Pullout"
author = "The Pullout developers"
copyright = author
version = release = tomllib.loads((Path(__file__).parent.parent / "Cargo.toml").read_text())["workspace"]["package"]["version"]
extensions = ["myst_nb", "sphinx_copybutton", "formulas", "tree"]
exclude_patterns = ["_build", ".venv", "requirements.txt"]

# a prime is a prime
smartquotes = False

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_fence_as_directive = ["formula"]
myst_heading_anchors = 3
myst_dmath_double_inline = False

# notebooks/: run where the package is installed; what goes wrong in one is an error of the book
is_there = importlib.util.find_spec("pullout_fe") is not None
has_dolfinx = importlib.util.find_spec("dolfinx") is not None
nb_execution_mode = "force" if is_there else "off"
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_merge_streams = True
if not is_there:
    print("pullout_fe is not installed in this environment: notebooks/ is shown without results")
elif not has_dolfinx:
    nb_execution_excludepatterns = ["notebooks/dolfinx.md"]
    print("dolfinx is not installed in this environment (it needs Python 3.12 or later on x86_64): notebooks/dolfinx.md is shown without results")
if not (is_there and has_dolfinx):
    # a cell that is not run does not say its language
    suppress_warnings = ["myst-nb.lexer"]

# outputs and formulas are not for copying
copybutton_selector = "div:not(.highlight-text):not(.output) > div.highlight pre"

html_theme = "furo"
html_title = f"Pullout {version}"
html_static_path = ["_static"]
html_css_files = ["book.css"]
html_js_files = ["book.js"]
html_math_renderer = "katex"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"font-stack": "system-ui, sans-serif"},
}

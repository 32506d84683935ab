"""The book: Markdown to HTML that needs no network, with every warning an error (`docs/build`)."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "Pullout"
author = "The Pullout developers"
copyright = author
extensions = ["myst_parser", "formulas", "tree"]
exclude_patterns = ["_build", ".venv", "requirements.txt"]

# a prime is a prime
smartquotes = False

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence"]
myst_fence_as_directive = ["formula"]
myst_heading_anchors = 3
myst_dmath_double_inline = False

html_theme = "furo"
html_title = "Pullout"
html_static_path = ["_static"]
html_css_files = ["book.css"]
html_math_renderer = "katex"
html_show_sphinx = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {"font-stack": "system-ui, sans-serif"},
}

# SPDX-License-Identifier: Apache-2.0
# How Sphinx makes the site. Run by site/build, which prepares the pages first (site/stage.py).
import os
import re
from pathlib import Path

root = Path(__file__).resolve().parent.parent

project = "tactus"
author = "The tactus contributors"
copyright = author
version = release = re.search(r"project\(tactus VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())[1]

extensions = ["myst_parser", "breathe", "sphinx.ext.graphviz", "sphinx.ext.mathjax"]
needs_sphinx = "5.3"
nitpicky = False
# A page may go from a first heading to a third.
suppress_warnings = ["myst.header"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 6
# A dollar sign in prose of the changelog is no mathematics.
myst_dmath_allow_space = False

breathe_projects = {"tactus": os.environ["TACTUS_DOXYGEN_XML"]}
breathe_default_project = "tactus"
breathe_default_members = ("members",)
breathe_show_define_initializer = True
breathe_show_include = False
# Search and links go by the names of classes and functions; the index of every member of the library would be one page of megabytes.
html_use_index = False
primary_domain = "cpp"
highlight_language = "text"

graphviz_output_format = "svg"
# Mathematics: the extension writes TeX into the page and loads this script on pages that have some. It is not MathJax, but runs KaTeX.
mathjax_path = "math.js"
mathjax_options = {"defer": "defer"}

html_theme = "furo"
html_title = f"tactus {version}"
html_static_path = ["static", os.environ["TACTUS_SITE_LIBRARIES"]]
html_css_files = ["site.css"]
html_favicon = str(root / "web/public/icon.svg")
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_permalinks_icon = "#"
html_theme_options = {"navigation_with_keys": False, "top_of_page_button": None}
html_search_language = "en"

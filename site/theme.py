#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes what Debian 12 ships of the theme Furo work from a folder of its own.

  site/theme.py FOLDER

Debian's style sheet imports another one from the root of the host, and has lost the rules for a browser that prefers dark; its
script is a module that is not loaded as one. Each repair is left out where it is not needed.
"""
import re
import shutil
import sys
from pathlib import Path

NORMALIZE = Path("/usr/share/javascript/normalize.css/normalize.css")


def with_dark_preferred(css):
    dark = re.search(r'body\[data-theme="dark"\] (\{[^{}]*--color-background-primary[^{}]*\})', css)
    if "prefers-color-scheme" in css or not dark:
        return css
    return css + f'\n@media not print {{\n  @media (prefers-color-scheme: dark) {{\n    body:not([data-theme="light"]) {dark[1]}\n  }}\n}}\n'


def main(static):
    style = static / "styles/furo.css"
    css = style.read_text()
    if "/javascript/normalize.css/" in css:
        css = css.replace("/javascript/normalize.css/", "")
        shutil.copy(NORMALIZE, style.parent)
    style.write_text(with_dark_preferred(css))
    script = static / "scripts/furo.js"
    code = script.read_text()
    imported = re.match(r'import Gumshoe from "\./(gumshoe-patched\.js)";\n', code)
    if imported:  # that file makes Gumshoe a global name
        script.write_text((script.parent / imported[1]).read_text() + code[imported.end():])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("use: site/theme.py FOLDER")
    main(Path(sys.argv[1]) / "_static")

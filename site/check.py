#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails where a page of the built site has a link that leads nowhere, an anchor that its target does not have, a path that works
at the root of a host only, or anything that a browser would fetch from another host.

  site/check.py FOLDER
"""
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# What a browser fetches by itself when it shows a page.
FETCHED = {("link", "href"), ("script", "src"), ("img", "src"), ("object", "data"), ("iframe", "src"), ("source", "src")}


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.anchors, self.links = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        for key in ("id", "name"):
            if values.get(key):
                self.anchors.add(values[key])
        for key in ("href", "src", "data"):
            if values.get(key) and not (tag == "link" and values.get("rel") in ("next", "prev", "index", "search")):
                self.links.append((values[key], (tag, key) in FETCHED))


def problems_of(folder):
    pages = {path: Page(path.read_text()) for path in sorted(folder.rglob("*.html"))}
    if not pages:
        yield f"there is no page in {folder}: run `make site` first"
    for path, page in pages.items():
        name = path.relative_to(folder)
        for link, fetched in page.links:
            parts = urlsplit(link)
            if parts.scheme in ("data", "mailto"):
                continue
            if parts.scheme or parts.netloc:
                if fetched:
                    yield f"{name}: a browser would fetch {link} from another host"
                continue
            if parts.path.startswith("/"):
                yield f"{name}: {link} works at the root of a host only"
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target = target / "index.html"
            if not target.exists():
                yield f"{name}: {link} leads to no file"
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                yield f"{name}: {link}: the page has no such anchor"
    for path in sorted(folder.rglob("*.css")):
        for link in re.findall(r"url\(\s*[\"']?([^\"')]+)", path.read_text()):
            # Of a font a browser takes the first format that it knows.
            if link.startswith(("data:", "#")) or link.endswith((".woff", ".ttf")):
                continue
            if re.match(r"([a-z]+:)?//", link):
                yield f"{path.relative_to(folder)}: a browser would fetch {link} from another host"
            elif not (path.parent / link.partition("?")[0]).exists() or link.startswith("/"):
                yield f"{path.relative_to(folder)}: {link} leads to no file of the site"


def check_of_itself():
    page = Page('<a id="there"></a><a href="gone.html#x">1</a><script src="https://example.org/x.js"></script>')
    if page.anchors != {"there"} or page.links != [("gone.html#x", False), ("https://example.org/x.js", True)]:
        yield f"this script reads a page wrongly: {page.anchors}, {page.links}"


def main():
    if len(sys.argv) != 2:
        sys.exit("use: site/check.py FOLDER")
    folder = Path(sys.argv[1]).resolve()
    problems = [*check_of_itself(), *problems_of(folder)]
    print("\n".join(problems) or f"{sum(1 for _ in folder.rglob('*.html'))} pages: every link and anchor leads somewhere.")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prepares the pages of the repository for Sphinx.

  site/stage.py FOLDER XML

Copies README.md, the pages of docs/ and the project's other pages into FOLDER. A link to a page becomes a link to its copy; a
link to another file or to a folder becomes a link to a page that shows it. The groups of docs/README.md become the
navigation. Headers of the kernel get a page each, which Breathe fills from Doxygen's XML, save concepts, which it does not know. A file that has not changed is not written again.
"""
import os
import re
import sys
import xml.etree.ElementTree as tree
from pathlib import Path

from flowchart import to_graphviz

root = Path(__file__).resolve().parent.parent
FRONT, LIST = "README.md", "docs/README.md"
PROJECT_PAGES = ["CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md"]
KERNEL = ["core", "signal", "mechanics", "arm", "control", "arm_control"]
LANGUAGES = {".cpp": "cpp", ".hpp": "cpp", ".json": "json", ".toml": "toml", ".urdf": "xml", ".yml": "yaml", ".txt": "cmake"}
LARGEST_SHOWN_BYTES = 30_000
EXPLAINER = '<a href="explainer/index.html"><b>Feel it in your browser</b></a>: three figures that run the kernel itself.'
CODE = re.compile(r"^([ \t]*)```.*?^\1```[ \t]*$|(`+)(?!`).*?(?<!`)\2(?!`)", flags=re.S | re.M)
LINK = re.compile(r"(\]\(\s*<?)([^)\s>]+)")


def staged_name(page):
    """Where the copy of a page is, relative to the folder of copies."""
    if page == FRONT:
        return "index.md"
    if page == LIST:
        return "pages.md"
    return page.removeprefix("docs/").lower() if "/" not in page else page.removeprefix("docs/")


def slug(heading):
    """The anchor of a heading, as MyST and GitHub make it."""
    heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def outside_code(text, change):
    """Applies `change` to what is neither a block nor a span of code."""
    parts, end = [], 0
    for code in CODE.finditer(text):
        parts += [change(text[end:code.start()]), code[0]]
        end = code.end()
    return "".join(parts) + change(text[end:])


def concepts_in(xml):
    """A text for each header that has concepts."""
    texts = {}
    for path in sorted(xml.glob("concept*.xml")):
        concept = tree.parse(path).getroot().find("compounddef")
        comment = [concept.find(part) for part in ("briefdescription", "detaileddescription")]
        words = "\n\n".join(" ".join("".join(part.itertext()).split()) for part in comment if part is not None)
        code = "".join(concept.find("initializer").itertext()).strip()
        header = concept.find("location").get("file")
        texts[header] = texts.get(header, "") + f"\n{words.strip()}\n\n```cpp\n{code}\n```\n"
    return texts


class Stage:
    def __init__(self, folder, xml):
        self.folder = Path(folder)
        self.concepts = concepts_in(Path(xml))
        self.written = set()
        self.anchors = {}
        self.shown = set()  # files and folders of the repository that need a page

    def write(self, name, content):
        path = self.folder / name
        self.written.add(path)
        content = content if isinstance(content, bytes) else content.encode()
        if not path.exists() or path.read_bytes() != content:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)

    def anchors_of(self, page):
        """What a page keeps of headings that were renamed: the old anchor, and that of the heading which follows. MyST resolves
        anchors of headings only."""
        if page not in self.anchors:
            text = (root / page).read_text()
            self.anchors[page] = {old: slug(heading) for old, heading in
                                  re.findall(r'^<a id="([^"]+)"></a>\n+#+ +(.*?) *#*$', text, flags=re.M)}
        return self.anchors[page]

    def target_of(self, page, link):
        """The link that the copy of `page` has where `page` has `link`."""
        if re.match(r"[a-z]+:", link):
            return link
        path, mark, anchor = link.partition("#")
        if not path:
            return mark + self.anchors_of(page).get(anchor, anchor)
        target = os.path.normpath(Path(page).parent / path)
        suffix = Path(target).suffix
        if suffix == ".md":
            name = staged_name(target)
            anchor = self.anchors_of(target).get(anchor, anchor)
        elif suffix in (".svg", ".png"):
            name = target.removeprefix("docs/")
            self.write(name, (root / target).read_bytes())
        else:
            self.shown.add(target)
            name = f"files/{target}.md"
        return os.path.relpath(name, Path(staged_name(page)).parent) + mark + anchor

    def page(self, page, extra=""):
        text = (root / page).read_text()
        text = re.sub(r"^```math$", "```{math}", text, flags=re.M)
        text = re.sub(r"^```mermaid\n(.*?)^```$", lambda chart: to_graphviz(chart[1]), text, flags=re.S | re.M)
        text = outside_code(text, lambda prose: LINK.sub(lambda link: link[1] + self.target_of(page, link[2]), prose))
        if page == FRONT:
            text = text.replace("\n\n", "\n\n" + EXPLAINER + "\n\n", 1)
        self.write(staged_name(page), text + extra)

    def show(self, target):
        """A page with the text of a file, or of all files of a folder."""
        path = root / target
        files = [path] if path.is_file() else sorted(file for file in path.rglob("*") if file.is_file())
        text = f"---\norphan: true\n---\n\n# {target}\n"
        for file in files:
            if len(files) > 1:
                text += f"\n## {file.relative_to(path)}\n"
            if file.stat().st_size > LARGEST_SHOWN_BYTES:
                text += f"\nThis file has {file.stat().st_size // 1000} kB: read it in the repository.\n"
                continue
            text += f"\n````{LANGUAGES.get(file.suffix, 'text')}\n{file.read_text().rstrip()}\n````\n"
        self.write(f"files/{target}.md", text)

    def groups(self):
        """(caption, pages) in the order of docs/README.md. A page is in the first group that lists it."""
        caption, found, seen = "", {}, {FRONT}
        for line in (root / LIST).read_text().splitlines():
            heading = re.match(r"## (.*)|\*\*(.*)\*\*$", line)
            if heading:
                caption = heading[1] or heading[2]
            elif caption:
                for _, link in LINK.findall(line):
                    target = os.path.normpath(Path(LIST).parent / link.partition("#")[0])
                    if target.endswith(".md") and target not in seen:
                        seen.add(target)
                        found.setdefault(caption, []).append(staged_name(target))
        return found | {"Project": [staged_name(page) for page in PROJECT_PAGES]}

    def reference(self):
        """The C++ reference: a page a header, a list a folder."""
        index = ("# The kernel in C++\n\nThis reference lists the public headers of the kernel, as their comments describe them.\n"
                 "\nThe kernel needs Eigen and the standard library only. Its control cycles neither allocate, lock nor throw.\n")
        for module in KERNEL:
            headers = sorted((root / "tactus/kernel" / module).rglob("*.hpp"))
            names = [str(header.relative_to(root)) for header in headers if "internal" not in header.parts]
            for name in names:
                self.write(f"reference/cpp/{name.removeprefix('tactus/kernel/')}.md",
                           f"# {name}\n\n```cpp\n#include <{name}>\n```\n\n```{{doxygenfile}} {name}\n```\n"
                           + self.concepts.get(name, ""))
            entries = "\n".join(name.removeprefix("tactus/kernel/") for name in names)
            self.write(f"reference/cpp/{module}.md", f"# Module {module}\n\n```{{toctree}}\n:maxdepth: 1\n\n{entries}\n```\n")
        index += "\n```{toctree}\n:maxdepth: 1\n\n" + "\n".join(KERNEL) + "\n```\n"
        self.write("reference/cpp/index.md", index)

    def run(self):
        pages = [str(page.relative_to(root)) for page in sorted(root.glob("docs/**/*.md"))]
        for page in [*pages, *PROJECT_PAGES, "CHANGELOG.md"]:
            self.page(page)
        groups = self.groups()
        groups["Reference"].append("reference/cpp/index.md")
        trees = "\n```{toctree}\n:hidden:\n\npages\n```\n"
        for caption, members in groups.items():
            trees += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n\n" + "\n".join(m.removesuffix(".md") for m in members) + "\n```\n"
        self.page(FRONT, trees)
        self.reference()
        for target in sorted(self.shown):
            self.show(target)
        for path in self.folder.rglob("*"):  # of pages that no longer exist
            if path.is_file() and path not in self.written:
                path.unlink()


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("use: site/stage.py FOLDER XML")
    Stage(sys.argv[1], sys.argv[2]).run()

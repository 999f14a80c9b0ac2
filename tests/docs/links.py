#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails where a link between pages leads nowhere, where docs/README.md does not list a page, where README.md is longer than
a page (900 words, as `wc -w` counts them), and where CITATION.cff has another version than the project."""
import os
import re
import sys
from pathlib import Path

root = Path(__file__).resolve().parent.parent.parent
LONGEST_README = 900


def without_code(text):
    text = re.sub(r"^([ \t]*)```.*?^\1```[ \t]*$", "", text, flags=re.S | re.M)
    return re.sub(r"(`+)(?!`)(.*?)(?<!`)\1(?!`)", r"\2", text, flags=re.S)


def anchors_of(text):
    """The names that GitHub gives to the headings of a page."""
    anchors, seen = set(), {}
    for heading in re.findall(r"^#{1,6} +(.*?) *#*$", without_code(text), flags=re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        count = seen.get(name, 0)
        seen[name] = count + 1
        anchors.add(f"{name}-{count}" if count else name)
    return anchors | set(re.findall(r'<a id="([^"]+)">', text))  # kept where a heading was renamed


def links_of(text):
    return re.findall(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)", without_code(text))


def problem_of(page, link, texts):
    if re.match(r"[a-z]+:", link):
        return ""
    path, _, anchor = link.partition("#")
    target = Path(os.path.normpath(root / page.parent / path)) if path else root / page
    if not target.exists():
        return f"{page}: {link} leads to no file"
    if not target.is_relative_to(root):
        return f"{page}: {link} leads out of the repository"
    if anchor and target.suffix == ".md":
        name = target.relative_to(root)
        if name not in texts:
            texts[name] = target.read_text()
        if anchor not in anchors_of(texts[name]):
            return f"{page}: {link}: the page has no such heading"
    return ""


def check_of_itself():
    """What the functions above must find."""
    page = "<a id=\"old\"></a>\n# One\n## A & `b`: it's\n## One\n```\n[no](gone.md)\n## code\n```\n[yes](gone.md)\n"
    if anchors_of(page) != {"one", "a--b-its", "one-1", "old"} or links_of(page) != ["gone.md"]:
        return [f"this script reads a page wrongly: {anchors_of(page)}, {links_of(page)}"]
    return [] if problem_of(Path("README.md"), "gone.md", {}) else ["this script misses a link that leads nowhere"]


def main():
    pages = [p.relative_to(root) for p in [*root.glob("*.md"), *root.glob("docs/**/*.md")]]
    texts = {page: (root / page).read_text() for page in pages}
    problems = check_of_itself()
    for page in sorted(pages):
        problems += filter(None, (problem_of(page, link, texts) for link in links_of(texts[page])))
    index = Path("docs/README.md")
    listed = {Path(os.path.normpath(index.parent / link.partition("#")[0])) for link in links_of(texts[index])}
    problems += [f"{index} does not list {page}" for page in sorted(pages) if page.parts[0] == "docs" and page != index
                 and page not in listed]
    words = len(texts[Path("README.md")].split())
    if words > LONGEST_README:
        problems.append(f"README.md has {words} words, more than {LONGEST_README}: move what newcomers do not need to a page of docs")
    version = re.search(r"project\(tactus VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())[1]
    if f"\nversion: {version}\n" not in (root / "CITATION.cff").read_text():
        problems.append(f"CITATION.cff: the version is not {version}, as in CMakeLists.txt")
    print("\n".join(problems) or f"{len(pages)} pages, README.md of {words} words.")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())

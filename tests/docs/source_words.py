#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails where a message, a help text or the comment of a public header uses a word that only this project has.

  tests/docs/source_words.py [FILE...]

Reads the string literals of tactus/ that are prose, and the comments of the headers that are installed, with the rules of
words.py. Identifiers are not read. Without FILE it reads all files of tactus/.
"""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from words import RULES, root

# (file, word as it is found, why it may stay)
EXCUSES = [
    ("tactus/data/report/figure.cpp", "tick", "a class of the style sheet: the tick of an axis"),
    ("tactus/runtime/servo/doctor.cpp", "ticks", "the ticks of the kernel"),
]
# In comments a tick is the type, or a parameter that is called so; in messages it is a control cycle.
TICK = r"\bticks?\b"

STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')


def comments_of(text):
    """(line, text) of each comment; code in it, `as this`, is blank."""
    for number, line in enumerate(text.split("\n"), 1):
        code = STRING.sub(lambda match: "x" * len(match[0]), line)
        at = code.find("//")
        if at >= 0 and not re.search(r"NOLINT|^\W*namespace ", line[at:]):
            yield number, re.sub(r"`[^`]*`", " ", line[at + 2:])


def strings_of(text):
    """(line, text) of each literal that is prose: it has a blank, and is not in a comment or the name of a header."""
    for number, line in enumerate(text.split("\n"), 1):
        if line.lstrip().startswith(("//", "#")):
            continue
        for match in STRING.finditer(line.split(" // ")[0].split("///")[0]):
            if " " in match[1].strip():
                yield number, re.sub(r"`[^`]*`|'[a-z_.-]+'", " ", match[1])


def is_public(file):
    return file.suffix == ".hpp" and "internal" not in file.parts


def findings_in(file):
    text = file.read_text()
    pieces = [(*piece, RULES) for piece in strings_of(text)]
    if is_public(file):
        pieces += [(*piece, [rule for rule in RULES if rule[0] != TICK]) for piece in comments_of(text)]
    for number, piece, rules in sorted(pieces, key=lambda piece: piece[0]):
        for pattern, use, _, _ in rules:
            for match in re.finditer(pattern, piece, flags=re.I):
                yield number, match[0], use


def main():
    wanted = [Path(argument).resolve() for argument in sys.argv[1:]]
    sources = wanted or sorted(file for suffix in ("hpp", "cpp") for file in (root / "tactus").rglob(f"*.{suffix}"))
    problems, used = [], set()
    for file in sources:
        name = str(file.relative_to(root))
        for number, word, use in findings_in(file):
            excuse = next((e for e in EXCUSES if e[0] == name and e[1].lower() == word.lower()), None)
            if excuse:
                used.add(excuse)
            else:
                problems.append(f"{name}:{number}: '{word}': write {use}")
    if not wanted:
        problems += [f"{e[0]}: '{e[1]}' is excused and does not occur" for e in EXCUSES if e not in used]
    print("\n".join(problems) or "No private word.")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())

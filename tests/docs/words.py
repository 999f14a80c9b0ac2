#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails where a page uses a word that only this project has, in place of the word of the field.

  tests/docs/words.py [PAGE...]

Prose alone is read: not code spans and blocks, quotations, link targets and comments. Without PAGE it reads all pages.
"""
import re
import sys
from pathlib import Path

root = Path(__file__).resolve().parent.parent.parent

# What the rule finds, the word to use, an example that it must find, and one that it must leave. The examples are tried first.
RULES = [
    (r"\bon the way\b|\bway (?:from|between|back|to the (?:leader|follower|hand|master|slave))\b", "transport, channel, link or path",
     "the delay on the way to the follower", "the only way to know"),
    (r"\b(?:un)?told\b|\btells?\b|\btelling\b", "reports, sends, commands; is identifiable", "the motor tells its torque", "a tall motor"),
    (r"\b(?:says?|said|saying)\b", "states, reports, shows, means", "the page says so", "they are so"),
    (r"\b(?:un)?heard\b|\bhears?\b", "received; not responding", "a motor that hears nothing", "an arm that hangs"),
    (r"\bsilent\b", "not responding; timed out", "a silent servo", "a silence of 1 s"),
    (r"\bpersons?\b", "operator", "a person holds it", "people hold it"),
    (r"\bwalls? before\b|\bsecond wall\b|\bbehind its wall\b", "device guard", "the wall before a device", "the wall"),
    (r"\b(?:stands?|stood|standing)\b(?! for\b)", "is, waits, is located, holds still", "where the arm stands", "which stands for it"),
    (r"\bbeside\b", "alongside, with, compared with", "beside the log", "besides"),
    (r"\bmend(?:s|ed|ing)?\b|\bputs? right\b", "fix, correct", "what mends it", "amendments"),
    (r"\banew\b", "again, restart, wrap around", "it begins anew", "a new run"),
    (r"\b(?:go|goes|went|gone|going) on\b", "continue", "the motor goes on", "the arm goes there"),
    (r"\blet(?:s|ting)? (?:it |all |both )?go\b", "releases; outputs zero force", "the site lets go", "let it settle"),
    (r"\bcarr(?:y|ies|ied|ying) (?:the |both |its |their |your )?(?:arms?|weight|themselves|itself)\b|\bweight comes in\b",
     "gravity compensation", "motors that carry the arm", "which carries messages"),
    (r"\bnot carried\b", "without gravity compensation", "the arm is not carried", "it is carried out"),
    (r"\bwish(?:es|ed)?\b", "request, operator input", "the wish of the operator", "the wash"),
    (r"\bverbs?\b", "command, subcommand", "the verbs of tactus", "verbose"),
    (r"\bpatience\b", "timeout", "its patience is over", "patients"),
    (r"\b(?:displays?|force|forces|that) ends? at \d", "limited to", "a display that ends at 1 N", "it ends at 6.2 mm"),
    (r"\bticks?\b", "control cycle", "once a tick", "sticks"),
    (r"\bstations?\b", "control loop", "the station of a site", "stationary"),
    (r"\bonlookers?\b|\blooks? on\b", "observers (log, live page, ROS 2)", "those who look on", "look at it"),
    (r"\bmisfits?\b|\b(?:keep|keeps|these|the) books\b|\bbelie(?:f|fs|ve|ves|ved)\b|\bpassages?\b",
     "mismatch, counters, model parameters, text blocks", "what the model believes", "a bookmark"),
    (r"\bbearable\b", "admissible force", "the bearable force", "bear a gain"),
    (r"\b(?:(?:soft|softer|firm|firmer) hands?|soft one)\b", "light grip, firm grip", "with a soft hand", "a firm one"),
    (r"\b(?:is|are|has|have|be) none\b|\bno number\b|\bnothing of it\b", "is not a number, has not been", "nothing of it was tried", "none settles"),
    (r"\bon (?:the )?metal\b", "on hardware", "not tried on metal", "a metal wall"),
]
# In a page for users leader and follower come first; master and slave are the papers' words.
LEADER_FIRST = (r"\b[Mm]asters?\b|\b[Ss]laves?\b", "leader, follower", "the master moves", "a masterpiece")

# (page, word as it is found, why it may stay)
EXCUSES = [
    ("README.md", "master", "the published name of the method"),
    ("docs/glossary.md", "person", "defines the operator"),
    ("docs/glossary.md", "soft hand", "defines a light grip, for pages and file names that have the old word"),
    ("docs/glossary.md", "told", "defines the force that the follower sends, for pages that have the old word"),
    ("CODE_OF_CONDUCT.md", "person", "is about people, not operators"),
    ("docs/how-to/combinations.md", "slave", "is in cells that tests/combinations reads"),
]


def prose_of(text):
    """Lines of a page with everything blanked that is no prose of its own."""
    def blank(match):
        return re.sub(r"[^\n]", " ", match[0])

    text = re.sub(r"<!--.*?-->", blank, text, flags=re.S)
    text = re.sub(r"^([ \t]*)(```|~~~).*?^\1\2[ \t]*$", blank, text, flags=re.S | re.M)
    text = re.sub(r"(?:(?<=\n\n)|(?<=\A))(?: {4}[^\n]*\n)+", blank, text)  # a block of code that is indented
    text = re.sub(r"\$\$.*?\$\$", blank, text, flags=re.S)
    text = re.sub(r"(`+)(?!`).*?(?<!`)\1(?!`)", blank, text, flags=re.S)
    text = re.sub(r"^>.*$", blank, text, flags=re.M)
    text = re.sub(r"“[^”]*”|\"[^\"\n]*\"", blank, text)
    text = re.sub(r"\]\([^)\s]*\)", blank, text)
    return text.split("\n")


def rules_of(page):
    for_users = page == "README.md" or page.startswith(("docs/how-to/", "docs/tutorial/"))
    return RULES + ([LEADER_FIRST] if for_users else [])


def findings_in(page, text):
    for number, line in enumerate(prose_of(text), 1):
        for pattern, use, _, _ in rules_of(page):
            for match in re.finditer(pattern, line, flags=re.I):
                yield number, match[0], use


def broken_rules():
    for pattern, _, wrong, right in RULES + [LEADER_FIRST]:
        if not re.search(pattern, wrong, flags=re.I):
            yield f"the rule {pattern} does not find its example: {wrong}"
        if re.search(pattern, right, flags=re.I):
            yield f"the rule {pattern} finds what it must leave: {right}"
    if "".join(prose_of("`the verb` \"the verb\"\n```\nthe verb\n```\n")).strip():
        yield "code or a quotation is read as prose"


def pages_there():
    folders = ["docs", "docs/how-to", "docs/theory", "docs/tutorial"]
    pages = {str(p.relative_to(root)) for folder in folders for p in (root / folder).glob("*.md")}
    by_hand = {"docs/reference/wire-format.md"}  # the rest of the reference is what the command prints
    return pages | by_hand | {p.name for p in root.glob("*.md")} - {"CHANGELOG.md"}


def main():
    wanted = sys.argv[1:]
    problems = list(broken_rules())
    used = set()
    for page in wanted or sorted(pages_there()):
        for number, word, use in findings_in(page, (root / page).read_text()):
            excuse = next((e for e in EXCUSES if e[0] == page and e[1].lower() == word.lower()), None)
            if excuse:
                used.add(excuse)
            else:
                problems.append(f"{page}:{number}: '{word}': write {use}")
    if not wanted:
        problems += [f"{e[0]}: '{e[1]}' is excused and does not occur" for e in EXCUSES if e not in used]
    print("\n".join(problems) or "No private word.")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Fails where a page uses a word that only this project has, in place of the word of the field.

  tests/docs/words.py [--all] [PAGE...]

Prose alone is read: not code spans and blocks, quotations, link targets and comments. Without PAGE it reads the pages of
CHECKED. Every page must be in CHECKED or in NOT_YET; a page that is rewritten moves from NOT_YET to CHECKED. --all reads both
and ends with status 0: a list of what is left.
"""
import re
import sys
from collections import Counter
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

# Pages that are written in the words of the field. This list only grows.
CHECKED = """
README.md CODE_OF_CONDUCT.md docs/README.md docs/glossary.md docs/versioning.md docs/tutorial/first-hour.md
docs/tutorial/two-arms.md docs/how-to/my-arm-buzzes.md docs/how-to/compare-methods.md docs/how-to/openarm.md
docs/how-to/yam.md docs/how-to/gello.md docs/how-to/so101.md docs/how-to/dynamixel-servos.md
docs/how-to/feetech-servos.md docs/how-to/inverse3.md docs/how-to/damiao-motors.md
docs/how-to/how-much-gain-is-safe.md docs/how-to/diagnose.md docs/how-to/your-own-device.md docs/how-to/ros2.md
docs/how-to/live-page.md docs/how-to/live-view.md docs/how-to/plug-in-your-own.md docs/how-to/two-hosts.md
docs/how-to/real-time.md docs/how-to/advise.md docs/how-to/combinations.md docs/how-to/components.md
docs/how-to/your-own-arm.md docs/how-to/python.md CONTRIBUTING.md SECURITY.md docs/theory/induced-master-motion.md docs/theory/stability.md
docs/theory/rivals.md docs/theory/contest.md docs/theory/cancellation-models.md docs/theory/force-estimators.md
docs/theory/hand-force.md docs/theory/frequency-responses.md docs/theory/signal-prediction.md
docs/theory/operator-impedance.md docs/theory/sensorless-teleoperation.md docs/theory/quick-identification.md
docs/theory/diagnosis.md docs/theory/servo-hydraulic-slave.md docs/theory/couplings.md docs/theory/four-channel.md
docs/theory/simulation.md docs/theory/maps.md docs/theory/passivity.md docs/theory/successive-isolation.md
docs/validation.md docs/theory/arm-margins.md docs/how-to/add-an-element.md docs/how-to/add-an-experiment.md
docs/theory/arms.md docs/theory/arm-identification.md docs/theory/arm-methods.md
docs/theory/arm-advice.md docs/theory/arm-vibration.md docs/theory/changing-grip.md docs/how-to/identify-your-master.md docs/how-to/logs.md
docs/architecture.md docs/how-to/identify-an-arm.md docs/how-to/identify-from-a-recording.md docs/how-to/rigs.md docs/how-to/faults.md
docs/theory/safety.md docs/reference/wire-format.md docs/how-to/site.md
""".split()

# Pages that have yet to be rewritten. This list only shrinks.
NOT_YET = """
""".split()

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
    wanted = [argument for argument in sys.argv[1:] if argument != "--all"]
    listed = set(CHECKED) | set(NOT_YET)
    problems = list(broken_rules())
    if not wanted:
        problems += [f"{page}: not in {Path(__file__).name}: add it to CHECKED" for page in sorted(pages_there() - listed)]
        problems += [f"{page}: is listed in {Path(__file__).name}, and does not exist" for page in sorted(listed - pages_there())]
        problems += [f"{page}: is in both lists of {Path(__file__).name}" for page in sorted(set(CHECKED) & set(NOT_YET))]
    if "--all" in sys.argv:
        for page in sorted(listed):
            found = Counter(word.lower() for _, word, _ in findings_in(page, (root / page).read_text()))
            if found:
                print(f"{page}: {sum(found.values())}: " + ", ".join(f"{word} {count}" for word, count in found.most_common(12)))
        return 0
    used = set()
    for page in wanted or CHECKED:
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

# SPDX-License-Identifier: Apache-2.0
"""Flowcharts of the pages, written in the part of Mermaid that they use, as Graphviz draws them: Sphinx draws those without a
program from elsewhere, and the reader's browser needs no script."""
import re

NODE = re.compile(r"\s*(\w+)(?:\(\((?P<round>[^)]*)\)\)|\[(?P<box>[^\]]*)\])?")
ARROW = re.compile(r"\s*(<?)-->(?:\|([^|]*)\|)?")


def quoted(text):
    return '"' + text.replace('"', r"\"") + '"'


class Statement:
    """One line: groups of nodes with arrows between them."""

    def __init__(self, line):
        self.line, self.at, self.output = line, 0, []

    def take(self, pattern):
        match = pattern.match(self.line, self.at)
        if match:
            self.at = match.end()
        return match

    def group(self):
        """Nodes with `&` between them."""
        names = []
        while True:
            node = self.take(NODE)
            if not node:
                raise ValueError(f"no node at column {self.at + 1} of the line '{self.line}' of a flowchart")
            names.append(node[1])
            if node["round"] is not None:
                self.output.append(f"{node[1]} [label={quoted(node['round'])} shape=circle]")
            elif node["box"] is not None:
                self.output.append(f"{node[1]} [label={quoted(node['box'])}]")
            if not self.take(re.compile(r"\s*&")):
                return names

    def graphviz(self):
        left = self.group()
        while arrow := self.take(ARROW):
            right = self.group()
            options = [f"label={quoted(' ' + arrow[2] + ' ')}"] if arrow[2] else []
            options += ["dir=both"] if arrow[1] else []
            self.output += [f"{a} -> {b} [{' '.join(options)}]" for a in left for b in right]
            left = right
        if self.line[self.at:].strip():
            raise ValueError(f"'{self.line[self.at:]}' in a flowchart is not understood")
        return self.output


def to_graphviz(chart):
    """A directive for Sphinx. Raises ValueError where a flowchart uses more of Mermaid than this understands."""
    lines = [line.strip() for line in chart.splitlines() if line.strip()]
    start = re.fullmatch(r"flowchart (TD|LR)", lines[0])
    if not start:
        raise ValueError(f"a flowchart starts with '{lines[0]}'; known are flowchart TD and flowchart LR")
    output = [f"rankdir={start[1].replace('TD', 'TB')}", 'bgcolor="transparent"',
              'node [shape=box style="rounded,filled" fillcolor="#f4f6f8" fontname="sans-serif" fontsize=11]',
              'edge [fontname="sans-serif" fontsize=9]']
    for line in lines[1:]:
        group = re.fullmatch(r"subgraph (\w+)\[(.*)\]", line)
        if group:
            output += [f"subgraph cluster_{group[1]} {{", f"label={quoted(group[2])}", 'fontname="sans-serif"', "style=rounded"]
        elif line == "end":
            output.append("}")
        else:
            output += Statement(line).graphviz()
    return "```{graphviz}\ndigraph {\n" + "\n".join(output) + "\n}\n```"

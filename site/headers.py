#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prepares Doxygen's XML for Breathe, which shows a header by `doxygenfile`.

  site/headers.py FOLDER

Doxygen keeps functions, enumerations and aliases with their namespace, and Breathe would show a whole namespace on the page of
every header. So members of namespaces move into the file that declares them, and files no longer refer to namespaces. Private
members go, and default values that the C++ parser of Sphinx does not know.
"""
import sys
import xml.etree.ElementTree as tree
from pathlib import Path


def is_unknown(value):
    """A designated initialiser."""
    return "{." in "".join(value.itertext()).replace(" ", "")


def without_what_sphinx_does_not_know(compound):
    for section in list(compound.findall("sectiondef")):
        if section.get("kind").startswith("private"):
            compound.remove(section)
        for member in section.findall("memberdef"):
            value = member.find("initializer")
            if value is not None and is_unknown(value):
                member.remove(value)
    for inner in list(compound.findall("innerclass")):
        if inner.get("prot") == "private":
            compound.remove(inner)


def main(folder):
    documents = {path: tree.parse(path) for path in sorted(folder.glob("*.xml")) if path.stem not in ("index", "Doxyfile")}
    compounds = {path: document.getroot().find("compounddef") for path, document in documents.items()}
    files = {c.find("location").get("file"): c for c in compounds.values() if c is not None and c.get("kind") == "file"}
    for compound in compounds.values():
        if compound is None:
            continue
        without_what_sphinx_does_not_know(compound)
        if compound.get("kind") != "namespace":
            continue
        for section in compound.findall("sectiondef"):
            moved = {}
            for member in list(section.findall("memberdef")):
                file = files.get(member.find("location").get("file"))
                if file is None:
                    continue
                section.remove(member)
                if id(file) not in moved:
                    moved[id(file)] = tree.SubElement(file, "sectiondef", {"kind": section.get("kind")})
                moved[id(file)].append(member)
    for file in files.values():
        for namespace in list(file.findall("innernamespace")):
            file.remove(namespace)
    for path, document in documents.items():
        document.write(path, encoding="UTF-8", xml_declaration=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("use: site/headers.py FOLDER")
    main(Path(sys.argv[1]))

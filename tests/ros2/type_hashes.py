#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""type_hashes.py IDL HEADER: the ROS 2 type hashes (RIHS01) in HEADER are those of the messages that IDL defines.

A hash is the SHA-256 of the message's description as JSON, the descriptions of all that it refers to sorted by name
(REP-2011 and REP-2016; `rosidl_generator_type_description` of ROS 2 Iron). The IDL is the one that is compiled, so a
member that is missing, misnamed or misplaced shows here.
"""

import hashlib
import json
import re
import sys

# What ROS 2 from Iron on announces, taken from nodes and from other programs that speak to them.
KNOWN = {
    "geometry_msgs/msg/WrenchStamped": "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77",
    "sensor_msgs/msg/JointState": "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
}

TYPE_IDS = {"long": 6, "unsigned long": 7, "double": 11, "string": 17}
NESTED, UNBOUNDED_SEQUENCE = 1, 144


def ros_name(dds_name):
    package, msg, _, name = dds_name.split("::")
    return f"{package}/{msg}/{name.removesuffix('_')}"


def field(idl_type, name):
    sequence = re.fullmatch(r"sequence<(.*)>", idl_type)
    element = sequence.group(1) if sequence else idl_type
    nested = "" if element in TYPE_IDS else ros_name(element)
    type_id = TYPE_IDS.get(element, NESTED) + (UNBOUNDED_SEQUENCE if sequence else 0)
    return {"name": name,
            "type": {"type_id": type_id, "capacity": 0, "string_capacity": 0, "nested_type_name": nested}}


def descriptions(idl):
    found = {}
    text = re.sub(r"//.*", "", idl)
    for package, content in re.findall(r"module (\w+) \{ module msg \{ module dds_ \{(.*?)\n\}; \}; \};", text, re.S):
        for name, members in re.findall(r"@final struct (\w+)_ \{(.*?)\};", content, re.S):
            fields = [field(*member) for member in re.findall(r"^\s*([\w:<> ]+?) (\w+);", members, re.M)]
            found[f"{package}/msg/{name}"] = {"type_name": f"{package}/msg/{name}", "fields": fields}
    return found


def referenced(name, types):
    for one in types[name]["fields"]:
        nested = one["type"]["nested_type_name"]
        if nested:
            yield nested
            yield from referenced(nested, types)


def type_hash(name, types):
    content = {"type_description": types[name],
               "referenced_type_descriptions": [types[other] for other in sorted(set(referenced(name, types)))]}
    return hashlib.sha256(json.dumps(content, separators=(", ", ": ")).encode()).hexdigest()


def main():
    types = descriptions(open(sys.argv[1], encoding="utf-8").read())
    header = open(sys.argv[2], encoding="utf-8").read()
    announced = dict(re.findall(r'type_name = "([\w/]+)".*?"RIHS01_([0-9a-f]{64})"', header, re.S))
    computed = {name: type_hash(name, types) for name in announced}
    for name, value in computed.items():
        print(name, value)
    assert computed == KNOWN, f"ROS 2 says {KNOWN}"
    assert announced == computed, f"the header announces {announced}"


main()

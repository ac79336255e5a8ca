"""Writes channels.h from channels.yaml: generate_channels.py channels.yaml OUT.h"""

import sys
from pathlib import Path

import yaml

table = yaml.safe_load(Path(sys.argv[1]).read_text(encoding="utf-8"))
out = [
    "// Generated from lcmtypes/channels.yaml. Do not edit.",
    "#pragma once",
    "",
    "namespace limber::channels {",
    "",
]
for plane, url in table["planes"].items():
    out.append(f'inline constexpr const char* k{plane.capitalize()}PlaneUrl = "{url}";')
out.append("")
for key, row in table["channels"].items():
    if "name" in row:
        continue  # the user-plane copy has the same name
    const = "k" + "".join(part.capitalize() for part in key.split("_"))
    comment = f"{row['type']}, from {row['from']}, {row['rate']}"
    out.append(f'inline constexpr const char* {const} = "{key}";  // {comment}')
out.append("")
for key, row in table["channels"].items():
    if row["rate"].startswith("cycle/"):
        const = "k" + "".join(part.capitalize() for part in key.split("_")) + "Every"
        out.append(
            f"inline constexpr int {const} = {int(row['rate'].removeprefix('cycle/'))};  // cycles"
        )
events = [f'"{key}"' for key, row in table["channels"].items() if row["rate"] == "event"]
out += [
    "",
    "// Their messages have no number that counts them: nobody can tell whether one is missing.",
    "inline constexpr const char* kUnnumbered[] = {",
    "    " + ", ".join(events) + "};",
    "",
    "}  // namespace limber::channels",
    "",
]
Path(sys.argv[2]).write_text("\n".join(out), encoding="utf-8")

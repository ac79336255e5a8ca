"""Writes problems.h from problems.yaml: generate_problems.py problems.yaml OUT.h"""

import json
import sys
from pathlib import Path

import yaml

groups = yaml.safe_load(Path(sys.argv[1]).read_text(encoding="utf-8"))["groups"]
messages = sorted({group["constants"].partition(".")[0] for group in groups.values()})
out = [
    "// Generated from lcmtypes/problems.yaml. Do not edit.",
    "#pragma once",
    "",
    *(f"#include <limber/{message}.hpp>" for message in messages),
    "",
    "namespace limber {",
    "",
    "/// A fault, refusal, verdict or limit in words; `value`: the constant of its message.",
    "struct Problem {",
    "  int value;",
    "  const char* code;",
    "  const char* what;",
    "  const char* remedy;",
    "};",
    "",
    "namespace problems {",
]
for key, group in groups.items():
    message, prefix = group["constants"].split(".")
    out += ["", f"inline constexpr Problem k{key.capitalize()}[] = {{"]
    for name, entry in group["problems"].items():
        words = [json.dumps(text) for text in (f"{key}.{name}", entry["what"], entry["do"])]
        out.append(f"    {{{message}::{prefix}{name}, {', '.join(words)}}},")
    out.append("};")
out += ["", "}  // namespace problems", "}  // namespace limber", ""]
Path(sys.argv[2]).write_text("\n".join(out), encoding="utf-8")

"""Writes the lists that edits.yaml changes into a folder, and prints their paths."""

import sys
from pathlib import Path

import yaml

HERE = Path(__file__).parent
ROOT = HERE.parents[1]


def main(out: Path) -> None:
    changed: dict[str, str] = {}
    for edit in yaml.safe_load((HERE / "edits.yaml").read_text(encoding="utf-8")):
        file = edit["file"]
        text = changed.get(file) or (ROOT / file).read_text(encoding="utf-8")
        if text.count(f"{edit['after']}\n") != 1:
            raise SystemExit(f"{file} has no line, or several, `{edit['after']}`")
        changed[file] = text.replace(
            f"{edit['after']}\n", f"{edit['after']}\n{edit['add'].rstrip()}\n"
        )
    out.mkdir(parents=True, exist_ok=True)
    for file, text in changed.items():
        path = out / file.replace("/", "_")
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main(Path(sys.argv[1]))

"""`limber first-hour` from the wires to the first push, with real processes and a simulated arm."""

import json
import subprocess
import sys


def led(answers: str, out, *words: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "limber", "first-hour", "desktop2r", "--out", str(out), *words]
    return subprocess.run(
        command, input=answers, capture_output=True, text=True, timeout=300, check=False
    )


def verdicts(out) -> dict[str, str]:
    content = json.loads((out / "first_hour.json").read_text(encoding="utf-8"))
    return {name: step["verdict"] for name, step in content["steps"].items()}


def test_from_the_wires_to_the_first_push(tmp_path):
    """Ends where the person is not sure of the pose, goes on there; directions are skipped."""
    out = tmp_path / "out"
    first = led("\nn\n", out)
    assert first.returncode == 1, first.stdout + first.stderr
    assert "shoulder: damiao_mit:1 on arm: replies as 0x11" in first.stdout
    assert "limber motors zero" in first.stdout
    assert verdicts(out) == {"wire": "passed", "motors": "passed", "zero": "failed"}
    again = led("\nn\n", out, "--from", "motors")  # each step may be done again
    assert again.returncode == 1, again.stdout + again.stderr
    assert verdicts(out)["motors"] == "passed" and verdicts(out)["zero"] == "failed"
    second = led("\n\ns\n\n\n", out)
    assert second.returncode == 1, second.stdout + second.stderr  # directions are left
    assert "motors: each motor" not in second.stdout
    found = verdicts(out)
    assert found.pop("directions") == "skipped"
    assert set(found.values()) == {"passed"}, second.stdout
    text = (out / "first_hour.md").read_text(encoding="utf-8")
    assert "1.00 of it" in text and "the tip was pushed by" in text


def test_nobody_to_answer_is_no_consent(tmp_path):
    done = led("", tmp_path / "out")
    assert done.returncode == 2 and "a person at the terminal has to answer" in done.stderr
    assert "zero" not in verdicts(tmp_path / "out")

"""`--page` opens the page beside a run; it ends with the run."""

import subprocess
import sys
import urllib.request

import pytest

from stack import ROOT


def test_a_page_beside_a_run_ends_with_it(tmp_path):
    command = [sys.executable, "-m", "limber", "run", ROOT / "scenarios" / "demo_short.yaml"]
    command += ["--lockstep", "--page", "--out", tmp_path]
    run = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    address = run.stdout.readline().split()[0]
    with urllib.request.urlopen(address) as answer:
        assert b"<html" in answer.read()
    output, _ = run.communicate(timeout=300)
    assert run.returncode == 0, output
    assert "refused" not in (tmp_path / "limber-controller.log").read_text(encoding="utf-8")
    with pytest.raises(OSError):
        urllib.request.urlopen(address)

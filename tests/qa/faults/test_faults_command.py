"""`limber dev faults`: rows listed, one row run, a wrong number told."""

import subprocess
import sys
from dataclasses import replace

import pytest
from typer.testing import CliRunner

from limber_qa.cli.faults import app
from limber_qa.faults.matrix import read_matrix


def faults(*words) -> subprocess.CompletedProcess:
    line = [sys.executable, "-m", "limber", "faults", *map(str, words)]
    return subprocess.run(line, capture_output=True, text=True, check=False)


def test_list_names_every_row():
    done = faults("list")
    assert done.returncode == 0
    starts = [line.split()[:2] for line in done.stdout.splitlines()]
    for row in read_matrix():
        assert [str(row.number), row.fault.split()[0]] in starts, row


def test_a_row_is_run():
    done = faults("run", 1, "--phases", 2)
    assert done.returncode == 0, done.stdout
    assert "ok controller silent: 4 cycles, safe frame after 3 ms" in done.stdout
    assert "test_controller_dies" in done.stdout


@pytest.mark.parametrize(("cycles", "told", "code"), [(1, "known", 0), (200, "MENDED", 1)])
def test_a_row_that_is_known_to_fail(monkeypatch, cycles, told, code):
    """Its failure is no surprise; that it passes is."""
    rows = read_matrix()
    row = next(row for row in rows if row.number == 36)
    fault = replace(row.lock_step[0], cycles=cycles, known_failing="for this test")
    rows[rows.index(row)] = replace(row, lock_step=[fault])
    monkeypatch.setattr("limber_qa.faults.matrix.read_matrix", lambda: rows)
    done = CliRunner().invoke(app, ["run", "36", "--phases", "1"])
    assert f"{told} the encoder freezes" in done.output
    assert done.exit_code == code


def test_a_row_that_is_none():
    done = faults("run", 99)
    assert done.returncode == 2
    assert "no row 99" in done.stderr

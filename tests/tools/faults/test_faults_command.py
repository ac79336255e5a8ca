"""`limber faults`: rows listed, one row run, a wrong number told."""

import subprocess
import sys

from limber.faults.matrix import read_matrix


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


def test_a_row_that_is_known_to_fail_is_no_surprise():
    done = faults("run", 36, "--phases", 1)
    assert "known the encoder freezes" in done.stdout
    assert done.returncode == 0


def test_a_row_that_is_none():
    done = faults("run", 99)
    assert done.returncode == 2
    assert "no row 99" in done.stderr

"""Files in a folder of results: no link followed, nothing foreign written over."""

import os

import pytest

from limber.errors import InputError, RunError
from limber.output import copy_new, new_file, write_again, write_new
from limber.paths import ROOT

SCENARIO = """format: limber-scenario/1
robot: desktop2r
mode: lockstep
duration_s: 0.5
"""


@pytest.fixture
def victim(tmp_path):
    path = tmp_path / "victim"
    path.write_text("mine")
    return path


@pytest.mark.parametrize("name", ["scenario.yaml", "robot.yaml", "robot.urdf", "limber-lab.log"])
@pytest.mark.parametrize("kind", ["link", "dangling", "file"])
def test_a_run_neither_follows_a_link_nor_writes_over_a_file(limber, victim, tmp_path, name, kind):
    (tmp_path / "s.yaml").write_text(SCENARIO)
    out = tmp_path / "out"
    out.mkdir()
    if kind == "file":
        (out / name).write_text("mine")
    else:
        (out / name).symlink_to(victim if kind == "link" else tmp_path / "nowhere")
    done = limber("lab", str(tmp_path / "s.yaml"), "--out", str(out))
    assert done.returncode == 2 and f"{out / name} " in done.stderr and "--out" in done.stderr
    assert victim.read_text() == "mine" and not (tmp_path / "nowhere").exists()
    if kind == "file":
        assert (out / name).read_text() == "mine"


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (["export", "mjcf", "desktop2r", "--out"], "arm.xml"),
        (["identify", "motion", "--robot", "desktop2r", "--out"], "tour.yaml"),
    ],
)
def test_a_link_gives_way_to_a_named_file(limber, victim, tmp_path, words, name):
    out = tmp_path / name
    out.symlink_to(victim)
    assert limber(*words, str(out)).returncode == 0
    assert victim.read_text() == "mine" and not out.is_symlink() and out.stat().st_size > 100


def test_the_helpers(victim, tmp_path):
    with pytest.raises(InputError, match="exists already"):
        write_new(victim, "x")
    with pytest.raises(InputError, match="exists already"):
        copy_new(ROOT / "README.md", victim)
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    with pytest.raises(InputError, match="is a link"):
        new_file(tmp_path / "link", "wb")
    write_again(victim, "über")
    assert victim.read_bytes() == "über".encode()
    with pytest.raises(InputError, match="cannot be written"):
        write_again(tmp_path / "no" / "file", "x")
    assert sorted(os.listdir(tmp_path)) == ["link", "victim"]


def test_what_fails_leaves_no_part_of_a_file(victim, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(RunError, match="No space left"):
        write_again(victim, "x")
    assert victim.read_text() == "mine" and os.listdir(tmp_path) == ["victim"]

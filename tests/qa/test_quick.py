"""`limber test --quick`: which tests belong to which files."""

import subprocess

import pytest

from limber_qa import quick


@pytest.mark.parametrize(
    ("file", "programs"),
    [
        ("controller/laws/pd_plus.cc", ["test_controller"]),
        ("tests/controller/laws/test_laws.cc", ["test_controller"]),
        ("drivers/gate/torque_gate.cc", ["test_gate"]),
        (
            "drivers/drive/drive.cc",
            ["test_can", "test_driver", "test_driver_processes", "test_gate", "test_protocols"],
        ),
        ("qa/soak/soak.cc", ["test_soak"]),
        ("robots/openarm/robot.yaml", ["test_robots"]),
        ("docs/safety.md", []),
        ("tools/limber/log/reader.py", []),
    ],
)  # fmt: skip
def test_the_programs_of_a_source(file, programs):
    assert quick.unit_tests([file]) == programs


@pytest.mark.parametrize(
    ("file", "folders"),
    [
        ("tools/limber/log/reader.py", ["tests/tools/log"]),
        ("tools/limber/errors.py", ["tests/tools"]),
        ("qa/limber_qa/quick.py", ["tests/qa"]),
        ("lecture/experiments/E01_static_stiffness/experiment.py", ["tests/lecture/experiments"]),
        ("README.md", ["tests/repo"]),
        ("controller/laws/pd_plus.cc", []),
    ],
)
def test_the_folders_of_a_python_file(file, folders):
    assert quick.python_tests([file]) == folders


def test_a_folder_that_holds_another_stands_for_it():
    assert quick.python_tests(["tools/limber/errors.py", "tools/limber/log/reader.py"]) == [
        "tests/tools"
    ]


def test_what_changed_is_what_differs_from_the_last_commit(tmp_path, monkeypatch):
    monkeypatch.setattr(quick, "ROOT", tmp_path)
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@b"]
    run = lambda *words: subprocess.run([*git, *words], cwd=tmp_path, check=True)  # noqa: E731
    run("init", "-q")
    for name in ("one", "two"):
        (tmp_path / name).write_text("")
        run("add", name)
        run("commit", "-qm", name)
    assert quick.changed() == ["two"]
    (tmp_path / "one").write_text("x")
    (tmp_path / "three").write_text("")
    assert quick.changed() == ["one", "three"]

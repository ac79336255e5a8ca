"""Lists that are kept by hand, against what they list."""

import re

from limber.doctor import machine
from limber.paths import ROOT
from limber_qa import selftest


def programs(without: tuple[str, ...] = ()) -> set[str]:
    """What CMake builds, without the benchmarks and some folders."""
    found = set()
    for folder in selftest.cxx_folders():
        if folder.name in without:
            continue
        for path in folder.rglob("CMakeLists.txt"):
            if path.parent.name != "bench":
                names = re.findall(r"^limber_program\(([\w-]+)", path.read_text(), re.MULTILINE)
                found |= {f"limber-{name}" for name in names}
    return found


def test_the_script_builds_and_doctor_knows_every_program():
    script = (ROOT / "limber").read_text()
    demo, beyond_demo, of_a_clone = (
        set(re.search(rf"^{name}=\((.*?)\)", script, re.MULTILINE)[1].split())
        for name in ("programs", "beyond_demo", "of_a_clone")
    )
    assert demo | beyond_demo | of_a_clone == {
        *programs(),
        *("limber_messages", "limber_receiver", "limber_lab_library"),
    }
    assert of_a_clone == programs() - programs(without=("qa", "lecture"))
    assert set(machine.PROGRAMS) == programs(without=("qa", "lecture"))


def test_clang_tidy_reads_the_headers_of_every_folder():
    listed = re.search(
        r"^HeaderFilterRegex: '\((.*)\)/'$", (ROOT / ".clang-tidy").read_text(), re.M
    )
    folders = {folder.name for folder in selftest.cxx_folders() if any(folder.rglob("*.h"))}
    assert set(listed[1].split("|")) == folders - {"tests"}


def test_every_folder_is_built_and_tested():
    """The order in CMakeLists.txt, and a folder of tests for each that holds code."""
    order = re.search(r"set\(LIMBER_FOLDERS ([\w ]+)", (ROOT / "CMakeLists.txt").read_text())
    folders = {folder.name for folder in selftest.cxx_folders()}
    assert set(order[1].split()) == folders - {"tests"}
    assert not [f for f in folders - {"tests", "lcmtypes"} if not (ROOT / "tests" / f).is_dir()]

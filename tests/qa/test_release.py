"""What a release folder is made of, as far as it needs no compiler."""

import subprocess
import tarfile
import tomllib
import zipfile

import pytest

from limber.paths import ASSETS, ROOT
from limber_qa import debian, release


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return {s: debian.write_sources(tmp_path_factory.mktemp(s), s) for s in debian.SUITES}


def test_the_packages_have_the_version_of_pyproject(sources):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    firsts = [
        (folder / "debian" / "changelog").read_text().splitlines()[0] for folder in sources.values()
    ]
    versions = [line.split("(")[1].split(")")[0] for line in firsts]
    assert versions == [f"{project['version']}+deb12", f"{project['version']}+deb13"]
    newer = ["dpkg", "--compare-versions", versions[1], "gt", versions[0]]
    assert subprocess.run(newer, check=False).returncode == 0


def test_all_that_is_installed_for_services_is_packaged(sources):
    """No file of assets/service is forgotten by debian/rules."""
    rules = (sources["trixie"] / "debian" / "rules").read_text(encoding="utf-8")
    for path in (ASSETS / "service").glob("limber.*.conf"):
        kind = path.name.split(".")[1]
        assert f"limber.{kind}.conf" in rules or f" {kind}" in rules.split("for kind in")[1], kind


def test_licences_come_out_of_the_wheel(tmp_path):
    wheel, out = tmp_path / "a.whl", tmp_path / "licences"
    out.mkdir()
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("limber/share/limber/licences/", "")  # pip's have folders, too
        archive.writestr("limber/share/limber/licences/orocos-kdl.txt", "LGPL")
        archive.writestr("limber/share/limber/robots/README.md", "no licence")
    release.copy_licences(wheel, out)
    assert {path.name for path in out.iterdir()} == {"limber.txt", "orocos-kdl.txt"}
    assert (out / "orocos-kdl.txt").read_text() == "LGPL"


def test_debug_files_lie_where_gdb_looks(tmp_path):
    """The same bytes each time."""
    build = tmp_path / "build"
    (build / "lib").mkdir(parents=True)
    source = tmp_path / "a.c"
    source.write_text("int limber_answer(void) { return 42; }\n", encoding="utf-8")
    library = build / "lib" / "liblimber_receiver.so"
    compiler = ["cc", "-g", "-shared", "-fPIC", "-Wl,--build-id=0x00ff1234", source, "-o", library]
    subprocess.run(compiler, check=True)
    archives = []
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        archives.append(release.build_debug_files(build, tmp_path / name))
    assert archives[0].read_bytes() == archives[1].read_bytes()
    with tarfile.open(archives[0]) as archive:
        assert "./.build-id/00/ff1234.debug" in archive.getnames()
        archive.extractall(tmp_path, filter="data")
    shown = subprocess.run(
        ["nm", tmp_path / ".build-id/00/ff1234.debug"], capture_output=True, text=True, check=True
    )
    assert "limber_answer" in shown.stdout

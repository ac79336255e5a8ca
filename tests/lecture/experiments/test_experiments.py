"""Experiments are found, run, judged and reported, also when some of them fail."""

import json
import re

import pytest

from limber.errors import OK, OUT_OF_TOLERANCE, RUN_FAILED, WRONG_INPUT

EXPERIMENT = """
from limber_lecture.comparison import Comparison
from .number import MEASURED

TITLE, CLAIM, SECTION, PLANT, FAST = "Title <b>", "It is so", "1", "a pen", {fast}

def run(context):
    context.progress("working")
    {body}
    return [Comparison("a number", 2.0, MEASURED, "N", 0.01)]
"""
DRAW = """with context.picture("seen") as ax:
        ax.plot([0, 1])"""
CLAIMS = """
sections: {"1": First, "2": Second}
claims:
  - {section: "1", claim: c1, verdict: holds, because: b1, shown_by: {E01: ""}}
  - {section: "2", claim: c2, verdict: does not hold, because: b2, shown_by: {E02: a num}}
  - {section: "2", claim: c3, verdict: holds with limits, because: b3, shown_by: {E77: ""}}
  - {section: "2", claim: c4, verdict: holds, because: b4, shown_by: {E01: "", E77: ""}}
"""


@pytest.fixture
def write(tmp_path):
    """Writes an experiment into the folder that is given to the program as --root."""

    def experiment(name: str, measured: str = "2.0", body: str = DRAW, fast: bool = True) -> None:
        folder = tmp_path / "root" / name
        folder.mkdir(parents=True)
        text = EXPERIMENT.format(body=body, fast=fast)
        (folder / "experiment.py").write_text(text, encoding="utf-8")
        (folder / "number.py").write_text(f"MEASURED = {measured}\n", encoding="utf-8")
        (tmp_path / "root" / "claims.yaml").write_text(CLAIMS, encoding="utf-8")

    return experiment


@pytest.fixture
def experiment(limber, tmp_path):
    def call(*words: str):
        root = ["--root", str(tmp_path / "root")]
        out = [] if words[0] == "list" else ["--out", str(tmp_path / "out")]
        return limber("experiment", *words, *root, *out)

    return call


def test_a_good_one_leaves_result_and_picture(write, experiment, tmp_path):
    write("E01_good")
    done = experiment("run", "e1")
    assert done.returncode == OK, done.stderr
    rows = json.loads((tmp_path / "out/E01/result.json").read_text())
    assert [(row["name"], row["pass"]) for row in rows] == [("a number", True)]
    assert (tmp_path / "out/E01/picture.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("measured", ["2.1", "float('nan')"])
def test_a_number_out_of_tolerance_is_exit_code_1(write, experiment, measured):
    write("E01_off", measured)
    done = experiment("run", "E01")
    assert done.returncode == OUT_OF_TOLERANCE
    assert "NO" in done.stdout


def test_one_failure_stops_nobody(write, experiment, tmp_path):
    write("E01_good")
    write("E02_off", "3.0")
    write("E03_broken", body="raise ValueError('no such pen')")
    write("E04_good")
    done = experiment("run", "all")
    assert done.returncode == RUN_FAILED
    assert "E03: no such pen" in done.stdout
    there = {key: (tmp_path / f"out/{key}/result.json").exists() for key in ("E02", "E03", "E04")}
    assert there == {"E02": True, "E03": False, "E04": True}
    assert "Traceback" in (tmp_path / "out/E03/error.txt").read_text()


def test_a_failure_does_not_leave_the_success_of_before(write, experiment, tmp_path):
    write("E01_good")
    assert experiment("run", "E01").returncode == OK
    (tmp_path / "root/E01_good/number.py").write_text("MEASURED = 1 / 0\n")
    assert experiment("run", "E01").returncode == WRONG_INPUT
    (tmp_path / "root/E01_good/number.py").write_text("MEASURED = 2.0\n")
    text = (tmp_path / "root/E01_good/experiment.py").read_text()
    broken = text.replace('context.progress("working")', "raise KeyError")
    (tmp_path / "root/E01_good/experiment.py").write_text(broken)
    assert experiment("run", "E01").returncode == RUN_FAILED
    assert not (tmp_path / "out/E01/result.json").exists()
    assert not (tmp_path / "out/E01/picture.png").exists()


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        ("pass", "drew nothing"),
        ("return []", "at least one"),
        ("return [1]", "list of Comparison"),
        (f"{DRAW}\n    return 2 * [Comparison('a', 1, 1, 'N', 0)]", "two checks are named 'a'"),
    ],
)
def test_half_an_experiment_is_an_error(write, experiment, body, complaint):
    write("E01_half", body=body)
    done = experiment("run", "E01")
    assert done.returncode == RUN_FAILED
    assert re.match(rf"limber: E01: .*{complaint}", done.stderr)


def test_only_the_fast_ones(write, experiment, tmp_path):
    write("E01_slow", fast=False)
    write("E02_fast")
    assert experiment("run", "all", "--fast").returncode == OK
    assert not (tmp_path / "out/E01").exists()
    done = experiment("run", "E01", "--fast")
    assert (done.returncode, "--fast leaves none" in done.stderr) == (WRONG_INPUT, True)


def test_wrong_numbers_and_folders_say_what_is_right(write, experiment, tmp_path):
    write("E01_good")
    done = experiment("run", "E99")
    assert (done.returncode, "E01" in done.stderr) == (WRONG_INPUT, True)
    write("E01_again")
    done = experiment("list")
    assert (done.returncode, "same number" in done.stderr) == (WRONG_INPUT, True)
    (tmp_path / "root/E01_again").rename(tmp_path / "root/E1_again")
    done = experiment("list")
    assert (done.returncode, "named like E04" in done.stderr) == (WRONG_INPUT, True)


def test_an_experiment_says_what_it_is(write, experiment, tmp_path):
    write("E01_good")
    path = tmp_path / "root/E01_good/experiment.py"
    path.write_text(path.read_text().replace('"a pen"', "3"))
    done = experiment("list")
    assert (done.returncode, "missing PLANT, a str" in done.stderr) == (WRONG_INPUT, True)


def test_the_report_holds_everything_itself(write, experiment, tmp_path):
    write("E01_good")
    write("E02_off", "3.0")
    experiment("run", "all")
    assert experiment("report").returncode == OK
    page = (tmp_path / "out/report.html").read_text()
    links = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert links and all(link.startswith(("data:", "#")) for link in links)
    assert not re.search(r"https?:|@import|url\(|<script", page)
    assert page.count("data:image/png;base64,") == 2
    assert "Title &lt;b&gt;" in page
    verdicts = re.findall(r'<span class="[a-z-]+">([^<]*)</span>', page)
    assert verdicts == ["holds", "not confirmed", "not yet measured", "partly measured"]


def test_a_report_of_nothing_is_refused(write, experiment):
    write("E01_good")
    done = experiment("report")
    assert (done.returncode, "experiment run all" in done.stderr) == (WRONG_INPUT, True)

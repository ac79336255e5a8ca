"""Anybody's recording: columns by name or number, units by scale; what is wrong is said."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hidden_arm import CONSTANT, GEAR, random_arm, record, write_robot

from limber.errors import InputError
from limber.identify import friction, stiffness
from limber.identify.arm import Arm, load_arm
from limber.identify.csv_recording import read_csv
from limber.identify.motion import motion_of

TABLE = """format: limber-columns/1
time_s: t
position: q{}
motor_position: m{}
motor_torque: i{}
joint_torque: s{}
"""
SIGNALS = {"q": "q", "m": "theta", "i": "motor", "s": "tau"}


@pytest.fixture(scope="module")
def arm(tmp_path_factory) -> Arm:
    return load_arm(str(write_robot(random_arm(3), tmp_path_factory.mktemp("arm"))))


@pytest.fixture(scope="module")
def recording():
    """With torque sensors."""
    return record(random_arm(3), 1)


def csv_text(recording, separator: str = ",") -> str:
    count = recording.q.shape[1]
    names = ["t"] + [f"{signal}{i + 1}" for signal in SIGNALS for i in range(count)]
    time_s = np.arange(len(recording.q)) / recording.rate_hz
    columns = [time_s] + [getattr(recording, name).T for name in SIGNALS.values()]
    lines = [separator.join(names)]
    lines += [separator.join(f"{x:.9g}" for x in row) for row in np.vstack(columns).T]
    return "\n".join(lines) + "\n"


def read(folder: Path, arm: Arm, text: str, table: str):
    (folder / "a.csv").write_text(text)
    (folder / "columns.yaml").write_text(table)
    return read_csv(folder / "a.csv", folder / "columns.yaml", arm)


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
def test_the_same_as_from_a_log(arm, recording, separator, tmp_path):
    found = read(tmp_path, arm, csv_text(recording, separator), TABLE)
    assert len(found) == 1 and found[0].motor_known
    both = [motion_of([each]) for each in (recording, found[0])]
    for module in (friction, stiffness):
        values = [
            [(v.joint, v.name, v.value, v.std) for v in module.identify(arm, motion).values]
            for motion in both
        ]
        assert [v[:2] for v in values[0]] == [v[:2] for v in values[1]] and values[0]
        for (*_, a, std), (*_, b, _) in zip(*values, strict=True):
            assert abs(a - b) < 0.5 * std


def test_numbers_scales_and_currents(arm, recording, tmp_path):
    """Degrees, a column that counts the other way, amperes, no header, no time."""
    count = recording.q.shape[1]
    rows = np.hstack([np.degrees(recording.q), recording.motor / (GEAR * CONSTANT)])
    rows[:, 0] *= -1.0
    np.savetxt(tmp_path / "b.txt", rows)
    table = f"""format: limber-columns/1
rate_hz: 200
position: {list(range(1, count + 1))}
motor_current: {list(range(count + 1, 2 * count + 1))}
scale: {{position: {[-np.pi / 180] + [np.pi / 180] * (count - 1)}}}
"""
    found = read(tmp_path, arm, (tmp_path / "b.txt").read_text(), table)[0]
    n = len(found.q)
    np.testing.assert_allclose(found.q, recording.q[:n], atol=1e-9)
    np.testing.assert_allclose(found.motor, recording.motor[:n], atol=1e-9)
    np.testing.assert_array_equal(found.theta, found.q)
    assert not found.torque_sensor.any() and not found.link_encoder.any()


def test_gaps_split(arm, recording, tmp_path):
    lines = csv_text(recording).splitlines()
    text = "\n".join(lines[:1001] + lines[1101:]) + "\n"
    found = read(tmp_path, arm, text, TABLE)
    assert len(found) == 2 and abs(len(found[0].q) - 1000) <= 1


def test_uneven_times_are_made_even(arm, recording, tmp_path):
    """Every other sample is 2 ms late; positions between are those of straight lines."""
    time_s = np.arange(len(recording.q)) / recording.rate_hz
    late = time_s + 2e-3 * (np.arange(len(time_s)) % 2)
    moved = {
        name: np.column_stack([np.interp(late, time_s, x) for x in getattr(recording, name).T])
        for name in SIGNALS.values()
    }
    lines = csv_text(replace(recording, **moved)).splitlines()
    text = [lines[0]] + [
        f"{t:.9g},{line.split(',', 1)[1]}" for t, line in zip(late, lines[1:], strict=True)
    ]
    found = read(tmp_path, arm, "\n".join(text) + "\n", TABLE)[0]
    at = np.arange(len(found.q)) / found.rate_hz
    for i, q in enumerate(recording.q.T):
        np.testing.assert_allclose(found.q[:, i], np.interp(at, time_s, q), atol=2e-4)


GOOD = "t,q1,q2,tau1,tau2\n" + "".join(f"{0.01 * k:.2f},0,0,0,0\n" for k in range(400))
OF_TWO = "format: limber-columns/1\ntime_s: t\nposition: q{}\nmotor_torque: tau{}\n"


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda c, t: (c.replace("1.00,0", "1.00,x"), t), "'x'"),
        (lambda c, t: (c.replace("1.00,0", "1.00,nan"), t), "line 102, column 2: not a finite"),
        (lambda c, t: (c.replace("1.00,", "0.98,"), t), "it does not grow from sample 100 to 101"),
        (lambda c, t: (c, t.replace("q{}", "p{}")), "no column 'p1'; there are: t, q1"),
        (lambda c, t: (c, t.replace("q{}", "[q1]")), "1 columns, the arm has 2 joints"),
        (lambda c, t: (c, t.replace("q{}", "[1, 6]")), "column 6 of 5"),
        (lambda c, t: (c, t.replace("/1", "/2")), "format is 'limber-columns/2'"),
        (lambda c, t: (c, t + "speed: v{}\n"), "speed is unknown"),
        (lambda c, t: (c, t.replace("motor_torque", "motor_position")), "is needed"),
        (lambda c, t: (c, t + "motor_current: tau{}\n"), "only one of them"),
        (lambda c, t: (c, t + "rate_hz: 100\n"), "either time_s or rate_hz"),
        (lambda c, t: (c, t + "scale: {position: 0}\n"), "finite and not 0"),
        (lambda c, t: (c, t + "scale: {position: [1, 2, 3]}\n"), "one number, or 2"),
        (lambda c, t: (c, t + "scale: {speed: 2}\n"), "as a mapping"),
        (lambda c, t: (c[: c.index("1.50,")], t), "nowhere 2 s without a gap"),
        (lambda c, t: (c, t.replace("time_s: t", "rate_hz: 5")), "rate_hz: 5; 20 to 20000"),
    ],
)
def test_what_is_wrong_is_said(change, reason, tmp_path):
    arm = load_arm("planar2r")
    assert read(tmp_path, arm, GOOD, OF_TWO)
    with pytest.raises(InputError, match=reason):
        read(tmp_path, arm, *change(GOOD, OF_TWO))


def lines_of(change) -> str:
    """GOOD with its lines changed."""
    lines = GOOD.splitlines()
    change(lines)
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            lambda c: c.__setitem__(301, "3.00,0,0,,0"),
            "line 302, column 4: .* the cell of tau1 is empty",
        ),
        (
            lambda c: c.insert(1, "s,rad,rad,Nm,Nm"),
            "line 2, column 1: .*'s' of t; take the line of units",
        ),
        (lambda c: c.__setitem__(7, "0.06,0,0,0"), "line 8: 4 columns, 5 before"),
        (
            lambda c: c.__setitem__(9, "0.08,0,0,0,-"),
            "line 10, column 5: not a finite number: '-' of tau2",
        ),
        (lambda c: c.insert(5, ""), None),
    ],
    ids=["blank", "units", "short", "dash", "empty line"],
)
def test_places_are_those_of_the_file(change, said, tmp_path):
    arm = load_arm("planar2r")
    if said is None:
        assert read(tmp_path, arm, lines_of(change), OF_TWO)
        return
    with pytest.raises(InputError, match=said):
        read(tmp_path, arm, lines_of(change), OF_TWO)


def test_decimal_commas_are_named(tmp_path):
    text = GOOD.replace(",", ";").replace("1.00;", "1,00;")
    with pytest.raises(
        InputError, match=r"line 102, column 1: .*'1,00' of t; write a decimal point"
    ):
        read(tmp_path, load_arm("planar2r"), text, OF_TWO)


@pytest.mark.parametrize(
    ("unit", "per_s"), [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)]
)
def test_times_in_other_units_are_told_and_scaled(unit, per_s, tmp_path):
    """The clock counts from 1970."""
    arm, start = load_arm("planar2r"), 1766147454 * int(per_s)
    rows = [f"{start + round(0.004 * k * per_s)},0,0,0,0" for k in range(800)]
    text = "t,q1,q2,tau1,tau2\n" + "\n".join(rows) + "\n"
    with pytest.raises(InputError, match=f"are the times {unit}?"):
        read(tmp_path, arm, text, OF_TWO)
    found = read(tmp_path, arm, text, OF_TWO + f"scale: {{time_s: {1 / per_s:.1e}}}\n")
    assert found[0].rate_hz == pytest.approx(250.0, rel=1e-3)


def test_command(arm, recording, limber, tmp_path):
    (tmp_path / "a.csv").write_text(csv_text(recording))
    (tmp_path / "columns.yaml").write_text(TABLE)
    words = ["identify", "stiffness", "--csv", str(tmp_path / "a.csv")]
    done = limber(*words)
    assert done.returncode == 2 and "--columns" in done.stderr
    words += ["--columns", str(tmp_path / "columns.yaml"), "--robot", str(arm.robot.folder)]
    done = limber(*words)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "identify" / "stiffness.yaml").is_file()

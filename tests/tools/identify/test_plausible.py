"""Recordings in other units are told with the scale that fits, and nothing is made of them; an
error that a warning knows of is in the figure's standard error.
"""

from dataclasses import replace

import numpy as np
import pytest
from two_joint_recording import COULOMB, RATED, VISCOUS, columns, record, text

from limber.errors import InputError
from limber.identify import friction, gravity, plausible, proposal
from limber.identify.arm import load_arm
from limber.identify.csv_recording import read_csv
from limber.identify.findings import Findings, Value
from limber.identify.motion import motion_of


@pytest.fixture(scope="module")
def arm():
    return load_arm("desktop2r")


@pytest.fixture(scope="module")
def recording():
    """In closed form: planar arm of desktop2r, no creep."""
    return record()


@pytest.fixture
def read(arm, tmp_path):
    def read_text(content: str, scale: str = ""):
        (tmp_path / "a.csv").write_text(content)
        (tmp_path / "columns.yaml").write_text(columns(scale))
        return read_csv(tmp_path / "a.csv", tmp_path / "columns.yaml", arm)

    return read_text


def refusal(arm, recordings) -> str:
    with pytest.raises(InputError) as refused:
        plausible.check(recordings, arm)
    return str(refused.value)


def test_right_units_pass_without_a_word(arm, recording, read):
    assert plausible.check(read(text(recording)), arm) == []


@pytest.mark.parametrize(
    ("change", "scale", "said"),
    [
        ({"q": 180.0 / np.pi}, "position: 0.0174533", "degrees? `scale: {position: 0.0174533}`"),
        ({"q": 1000.0}, "position: 0.001", "milliradians? `scale: {position: 0.001}`"),
        ({"motor": 1000.0 / RATED}, "motor_torque: 0.007", "thousandths of the rated torque?"),
        ({"motor": 1000.0}, "motor_torque: 0.001", "mN m? `scale: {motor_torque: [0.001, 0.001]}`"),
    ],
    ids=["degrees", "milliradians", "per mille", "millinewton metres"],
)
def test_other_units_are_told_and_the_scale_that_is_told_mends_them(
    arm, recording, read, change, scale, said
):
    scaled = replace(recording, **{k: getattr(recording, k) * f for k, f in change.items()})
    assert said in refusal(arm, read(text(scaled)))
    assert plausible.check(read(text(scaled), scale), arm) == []


def test_speeds_that_no_joint_reaches(arm, recording):
    """Degrees of a small motion lie within the ends, their speed does not; wrong times do that,
    too.
    """
    small = replace(recording, q=np.degrees(recording.q) * 0.02, rate_hz=50 * recording.rate_hz)
    assert "its limit is 20 rad/s" in refusal(arm, [small])


def test_a_torque_of_another_size_or_sign_than_the_weight_is_doubted(arm, recording):
    """Within what the motor makes: somebody's share of the rated torque, a motor that counts the
    other way.
    """
    share = replace(recording, motor=recording.motor / RATED)
    assert "shoulder: motor_torque times 7" in plausible.check([share], arm)[0]
    turned = replace(recording, motor=recording.motor * [-1.0, 1.0])
    (doubt,) = plausible.check([turned], arm)
    assert doubt.startswith("shoulder: motor_torque times -") and "the other way?" in doubt


def test_nothing_is_written_of_a_recording_in_degrees(limber, recording, tmp_path):
    wrong = replace(recording, q=np.degrees(recording.q))
    (tmp_path / "a.csv").write_text(text(wrong))
    (tmp_path / "columns.yaml").write_text(columns())
    words = ["--csv", str(tmp_path / "a.csv"), "--columns", str(tmp_path / "columns.yaml")]
    for kind in ("gravity", "friction"):
        done = limber(
            "identify", kind, *words, "--robot", "desktop2r", "--out", str(tmp_path / "o")
        )
        assert done.returncode == 2 and "are these" not in done.stdout
        assert "its ends are -2.6 and 2.6 rad" in done.stderr
    assert not (tmp_path / "o").exists()


def test_without_slow_samples_the_error_of_coulomb_friction_holds_a_third(arm, recording):
    found = friction.identify(arm, motion_of([recording]))
    assert any("may be a third too high" in note for note in found.notes)
    for value, truth in zip(found.values[::2], COULOMB, strict=True):
        assert value.name.endswith("coulomb_Nm")
        assert value.std >= value.value / 6
        assert abs(value.value - truth) < value.std
    for value, truth in zip(found.values[1::2], VISCOUS, strict=True):
        assert abs(value.value - truth) < 3 * value.std


def test_what_does_not_stand_out_from_nothing_is_not_proposed(arm, tmp_path):
    path = ("joints", "shoulder", "friction")
    values = [
        Value(
            "shoulder", "friction: coulomb_Nm", "N m", 57.6, 71.0, 0.05, (*path, "coulomb_Nm"), 57.6
        ),
        Value("shoulder", "x", "N m", 0.02, 0.005, 0.03, (*path, "viscous_Nms_per_rad"), 0.02),
    ]
    proposal.write(Findings("friction", values), arm, "friction", tmp_path)
    written = (tmp_path / "friction.yaml").read_text()
    assert "viscous" in written and "coulomb" not in written


def test_a_link_that_makes_a_joint_worse_stays_and_is_named(arm, recording, monkeypatch):
    """The elbow's torque would be explained worse with link2 changed: link1 is proposed alone."""

    def judged(loads, parts, used, kept):
        weights = real(loads, parts, used, kept)[0]
        before = np.array([1.0, 1.0])
        return weights, before, np.array([0.3, 0.9 if 1 in kept else 1.5])

    real = gravity._judged
    monkeypatch.setattr(gravity, "_judged", judged)
    found = gravity.identify(arm, motion_of([recording]))
    assert found.inertials
    (note,) = [note for note in found.notes if note.startswith("Left as in the URDF")]
    assert "link2" in note and "elbow (1.5 N m rms instead of 1)" in note
    mass, com = found.inertials["link2"]
    assert mass == pytest.approx(0.8, abs=1e-9) and com == pytest.approx([0.15, 0, 0], abs=1e-9)

"""Several runs in one log are told apart; single messages that do not fit end nothing."""

import numpy as np
import pytest
from made_logs import records, write_log

from limber.errors import InputError
from limber.identify.arm import load_arm
from limber.identify.recording import read_logs
from limber.log.events import Names, events
from limber.log.reader import Log
from limber.messages import message_class

State = message_class("joint_state_t")
Status = message_class("controller_status_t")
MS = 10**6


def run(count: int = 3000, law: int = 0, session: int = 1, **fields) -> dict[str, np.ndarray]:
    """One run from arm time zero on."""
    state = records(
        "joint_state_t",
        count,
        time_ns=np.arange(count) * MS,
        num_joints=2,
        session=session,
        period_ns=MS,
        fault_joint=-1,
        drive_state=State.DRIVE_ON,
        **fields,
    )
    state["joint_flags"][:, :2] = State.JOINT_ENABLED
    status = records("controller_status_t", count // 5, mode=Status.MODE_ACTIVE, law=law)
    status["time_ns"] = np.arange(count // 5) * 5 * MS
    return {"JOINT_STATE": state, "CONTROLLER_STATUS": status}


def one_file(folder, *runs):
    """Logs put into one file, one after the other."""
    path = folder / "log"
    parts = [write_log(folder / f"{i}", made).read_bytes() for i, made in enumerate(runs)]
    path.write_bytes(b"".join(parts))
    return path


def test_one_run_is_one(tmp_path):
    log = Log(write_log(tmp_path / "log", run()))
    assert log.runs == 1 and log.of_run(1) is log
    assert log.one_run() == (log, "")


@pytest.mark.parametrize("sessions", [(1, 1, 1), (7, 9, 4)], ids=["time goes back", "session"])
def test_each_run_has_its_own_messages(tmp_path, sessions):
    runs = [run(1000 * (i + 1), law=i, session=s) for i, s in enumerate(sessions)]
    log = Log(one_file(tmp_path, *runs))
    assert log.runs == 3
    for i, part in enumerate(log.each_run()):
        assert len(part.channels["JOINT_STATE"]) == 1000 * (i + 1)
        assert set(part.read("CONTROLLER_STATUS")["law"]) == {i}
        assert part.length_s == pytest.approx(1.0 * (i + 1), abs=0.01)
        assert len(list(part.in_order({"JOINT_STATE"}))) == 1000 * (i + 1)
    assert log.one_run()[1] == "run 3 of 3" and log.one_run(2)[1] == "run 2 of 3"
    with pytest.raises(InputError, match=r"--run 4: .* holds 3 runs"):
        log.of_run(4)


def test_a_session_that_changes_while_time_goes_on_is_a_new_run(tmp_path):
    state = run()["JOINT_STATE"]
    state["session"][1200:] = 5
    log = Log(write_log(tmp_path / "log", {"JOINT_STATE": state}))
    assert [len(part.read("JOINT_STATE")) for part in log.each_run()] == [1200, 1800]


@pytest.mark.parametrize(("field", "value"), [("session", 99), ("time_ns", 0), ("time_ns", 10**15)])
def test_single_messages_end_no_run(tmp_path, field, value):
    made = run()
    made["JOINT_STATE"][field][[700, 1500]] = value
    path = tmp_path / "log"
    write_log(path, {"JOINT_STATE": run()["JOINT_STATE"]})  # in the order of a file
    data = path.read_bytes()
    good, bad = run()["JOINT_STATE"], made["JOINT_STATE"]
    for row in (700, 1500):
        data = data.replace(good[row].tobytes(), bad[row].tobytes())
    path.write_bytes(data)
    assert Log(path).runs == 1


def test_two_senders_at_once_are_one_run(tmp_path):
    one, two = run(session=1)["JOINT_STATE"], run(session=2)["JOINT_STATE"]
    both = np.concatenate([one, two]).astype(one.dtype)
    log = Log(write_log(tmp_path / "log", {"JOINT_STATE": both}))
    assert log.runs == 1


def test_commands_by_run(limber, tmp_path):
    log = one_file(tmp_path, run(law=0), run(law=1))
    told = limber("log", "info", str(log)).stdout
    assert "2 runs, one after the other" in told and "run 2: 3600 messages in 3.00 s" in told
    listed = limber("log", "events", str(log)).stdout
    places = [listed.index("run 1 of 2"), listed.index("mode ACTIVE")]
    places += [listed.index("run 2 of 2"), listed.rindex("mode ACTIVE")]
    assert places == sorted(places) and listed.count("mode ACTIVE") == 2
    only = limber("log", "events", str(log), "--run", "2").stdout
    assert "run 2 of 2" in only and "run 1 of 2" not in only
    rates = limber("log", "rate", str(log)).stdout
    assert rates.count("1000.000") == 2 and "run 2 of 2" in rates
    drawn = limber("plot", str(log), "--out", str(tmp_path / "plots"), "--what", "joint")
    assert "run 2 of 2 is drawn; --run chooses another" in drawn.stdout
    assert "run 2 of 2" in (tmp_path / "plots" / "plot.html").read_text()
    out = tmp_path / "cut.lcmlog"
    assert limber("log", "cut", str(log), "--run", "2", "--out", str(out)).returncode == 0
    assert Log(out).runs == 1 and set(Log(out).read("CONTROLLER_STATUS")["law"]) == {1}


def test_identify_reads_run_by_run(tmp_path):
    """The numbers of the second go on where those of the first end."""
    second = run()
    second["JOINT_STATE"]["seq"] += 3000
    path = one_file(tmp_path, run(), second)
    arm = load_arm("desktop2r")
    assert [len(recording.q) for recording in read_logs([path], arm)] == [3000, 3000]
    assert len(read_logs([path], arm, run=2)) == 1


def test_events_of_a_run_are_its_own(tmp_path):
    log = Log(one_file(tmp_path, run(law=0), run(law=1)))
    names = Names(["a", "b"], ["joint_pd", "levant"])
    laws = [
        [event.text for event in events(part, names) if event.text.startswith("law")]
        for part in log.each_run()
    ]
    assert laws == [["law joint_pd"], ["law levant"]]

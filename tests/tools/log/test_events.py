"""The list of what happened, from messages whose story is known."""

import numpy as np
from made_logs import event_bytes, records, write_log

from limber.log.events import Names, events
from limber.log.reader import Log
from limber.messages import SCENARIO_CLIENT, message_class

State = message_class("joint_state_t")
Status = message_class("controller_status_t")
Driver = message_class("driver_status_t")
Answer = message_class("request_answer_t")
Mode = message_class("mode_request_t")
NAMES = Names(["shoulder", "elbow"], ["joint_pd", "cartesian_impedance"])
MS = 10**6


def story(tmp_path, answers=(), **channels) -> list[tuple[float, str, str]]:
    path = write_log(tmp_path / "log", channels)
    with open(path, "ab") as file:
        for answer in answers:
            file.write(event_bytes("REQUEST_ANSWER", answer.encode()))
    return [(round(event.time_s, 6), event.who, event.text) for event in events(Log(path), NAMES)]


def states(count=1000, **fields) -> np.ndarray:
    return records(
        "joint_state_t",
        count,
        time_ns=np.arange(count) * MS,
        num_joints=2,
        fault_joint=-1,
        **fields,
    )


def test_faults_have_code_and_joint_and_the_drives_their_words(tmp_path):
    state = states(drive_state=State.DRIVE_ON)
    state["drive_state"][500:] = State.DRIVE_HOLD
    state["fault"][500:], state["fault_joint"][500:] = State.FAULT_POSITION, 1
    state["joint_flags"][498:520, 1] = State.JOINT_OUT_OF_RANGE
    status = records("controller_status_t", 200, mode=Status.MODE_ACTIVE, reason_joint=-1)
    status["time_ns"] = np.arange(200) * 5 * MS
    status["mode"][101:], status["reason"][101:] = Status.MODE_FAULT, Status.REASON_DRIVER_FAULT
    found = story(tmp_path, JOINT_STATE=state, CONTROLLER_STATUS=status)
    told = [(at, who, text.split(": ")[:2]) for at, who, text in found]
    assert told == [
        (0.0, "driver", ["drives ON"]),
        (0.0, "controller", ["mode ACTIVE"]),
        (0.0, "controller", ["law joint_pd"]),
        (0.498, "driver", told[3][2]),
        (0.5, "driver", ["drives FALLBACK", "driver.POSITION (elbow)"]),
        (0.505, "controller", ["mode FAULT", "controller.DRIVER_FAULT"]),
    ]
    assert told[3][2][0] == "joint.OUT_OF_RANGE (elbow) for 0.021 s"


def test_requests_are_named_with_who_and_why_not(tmp_path):
    taken, refused = Answer(), Answer()
    taken.client, taken.accepted, taken.time_ns = SCENARIO_CLIENT, 1, 300 * MS
    taken.kind, taken.what = Answer.KIND_MODE, Mode.REQUEST_HOLD
    refused.client, refused.time_ns, refused.kind = 77, 900 * MS, Answer.KIND_GAINS
    refused.code, refused.reason = Answer.REFUSED_LEASE, "somebody else has it"
    found = story(tmp_path, [taken, refused], JOINT_STATE=states())
    assert (0.3, "scenario", "mode hold: taken") in found
    assert (0.9, "client 77", "gains: refused: request.LEASE: somebody else has it") in found


def test_limits_pushes_and_contacts_are_one_line_each_with_their_length(tmp_path):
    status = records("controller_status_t", 200, mode=Status.MODE_ACTIVE)
    status["time_ns"] = np.arange(200) * 5 * MS
    status["limits"][20:40] = Status.LIMIT_TORQUE
    status["limits"][30] = 0  # a pause of 10 ms
    status["limits"][100:105] = Status.LIMIT_TORQUE | Status.LIMIT_SPRING
    truth = records("sim_truth_t", 1000, time_ns=np.arange(1000) * MS)
    truth["F_push"][200:700, 1] = 9
    truth["contact"][800:900] = 1
    truth["F_contact"][800:900, 0] = np.linspace(0, -12, 100)
    found = story(tmp_path, CONTROLLER_STATUS=status, SIM_TRUTH=truth)
    limits = [(at, text.split(": ")[0]) for at, _, text in found if text.startswith("limit.")]
    assert limits == [
        (0.1, "limit.TORQUE for 0.095 s"),
        (0.5, "limit.TORQUE for 0.02 s"),
        (0.5, "limit.SPRING for 0.02 s"),
    ]
    assert (0.2, "world", "push for 0.499 s, up to 9 N") in found
    assert (0.8, "world", "contact for 0.099 s, up to 12 N") in found


def test_buses_stops_sensors_and_the_gate(tmp_path):
    driver = records("driver_status_t", 10, num_buses=2)
    driver["time_ns"] = np.arange(10) * 100 * MS
    driver["bus_state"][3:5, 1] = Driver.BUS_OFF
    driver["commands_refused"][6:, Driver.VERDICT_RATE] = 4
    driver["commands_refused"][:, Driver.VERDICT_STALE] = 2
    state = states()
    state["emergency_stop"][:] = State.STOP_RELEASED
    state["emergency_stop"][700:] = State.STOP_PRESSED
    state["sensor_state"][100:150] = State.SENSOR_ERROR
    found = [
        (at, text.split(": "))
        for at, _, text in story(tmp_path, JOINT_STATE=state, DRIVER_STATUS=driver)
    ]
    told = [(at, words[:2]) for at, words in found]
    assert (0.3, ["bus 2", "bus.OFF"]) in told and (0.5, ["bus 2", "good again"]) in told
    refused = [(at, words) for at, words in told if words[0].startswith("gate.")]
    assert refused == [
        (0.0, ["gate.STALE", "2 commands refused"]),
        (0.6, ["gate.RATE", "4 commands refused"]),
    ]
    assert (0.7, ["stop.PRESSED", "the emergency stop is pressed"]) in told
    assert [at for at, words in told if words[0] == "sensor.ERROR"] == [0.1]
    assert not [words for _, words in told if words[0].startswith("bus 1")]


def test_the_end_that_somebody_wanted_is_no_fault(tmp_path):
    """The drives go to DAMP by request, and the controller's FAULT follows from it."""
    status = records("controller_status_t", 200, mode=Status.MODE_ACTIVE, reason_joint=-1)
    status["time_ns"] = np.arange(200) * 5 * MS
    status["mode"][100:], status["reason"][100:] = Status.MODE_FAULT, Status.REASON_DRIVER_FAULT
    for fault, bad in ((State.FAULT_REQUESTED, False), (State.FAULT_POSITION, True)):
        state = states(drive_state=State.DRIVE_ON)
        state["drive_state"][500:], state["fault"][500:] = State.DRIVE_DAMP, fault
        log = write_log(tmp_path / str(fault), {"JOINT_STATE": state, "CONTROLLER_STATUS": status})
        found = [event for event in events(Log(log), NAMES) if "mode FAULT" in event.text]
        assert [event.bad for event in found] == [bad]

"""Stamps of ROS from arm time."""

from limber.live.stack_link import LOCKSTEP_SESSION
from limber.live.stamps import Stamps

SESSION = 7
MS, S = 1_000_000, 1_000_000_000
EPOCH = 1_700_000_000 * S


def test_the_way_here_is_no_part_of_a_stamp():
    """Messages come 2 to 30 ms late: all stamps are those of the quickest."""
    stamps = Stamps()
    for i, late_ms in enumerate((30, 2, 17, 9, 30)):
        arm_ns = i * 10 * MS
        now_ns = EPOCH + arm_ns + late_ms * MS
        stamps.note(SESSION, arm_ns, now_ns)
        stamp = stamps.of(arm_ns, now_ns)
        assert stamp <= now_ns
        if i:
            assert abs(stamp - (EPOCH + arm_ns + 2 * MS)) <= 0.1 * MS  # the drift permitted


def test_an_older_message_has_an_older_stamp():
    stamps = Stamps()
    stamps.note(SESSION, 50 * MS, EPOCH)
    assert stamps.of(45 * MS, EPOCH) == EPOCH - 5 * MS


def test_a_clock_that_is_set_is_followed():
    for step_ns in (-3600 * S, 3600 * S):
        stamps = Stamps()
        stamps.note(SESSION, 0, EPOCH)
        stamps.note(SESSION, 10 * MS, EPOCH + 10 * MS + step_ns)
        assert stamps.of(10 * MS, EPOCH + 10 * MS + step_ns) == EPOCH + 10 * MS + step_ns


def test_a_new_session_begins_anew():
    stamps = Stamps()
    stamps.note(SESSION, 300 * MS, EPOCH)
    stamps.note(SESSION + 1, 0, EPOCH + S // 2)
    assert stamps.of(0, EPOCH + S // 2) == EPOCH + S // 2


def test_in_lock_step_it_is_the_time_of_arrival():
    stamps = Stamps()
    stamps.note(LOCKSTEP_SESSION, 0, EPOCH)
    stamps.note(LOCKSTEP_SESSION, 5 * MS, EPOCH + 50 * MS)
    assert stamps.of(5 * MS, EPOCH + 50 * MS) == EPOCH + 50 * MS

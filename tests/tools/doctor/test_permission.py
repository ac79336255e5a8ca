"""The cure for a driver that may not use SCHED_FIFO, by kind of installation."""

from limber import paths
from limber.doctor import machine


def test_an_installed_driver_gets_no_capabilities(monkeypatch):
    """It would ignore $ORIGIN, and with it its libraries."""
    warned = "".join(finding.cure for finding in findings(monkeypatch, in_a_clone=False))
    assert "limits.d" in warned and "setcap" not in warned


def test_that_of_a_clone_may_have_them(monkeypatch):
    warned = "".join(finding.cure for finding in findings(monkeypatch, in_a_clone=True))
    assert "limits.d" in warned and "setcap" in warned


def findings(monkeypatch, in_a_clone: bool) -> list[machine.Finding]:
    monkeypatch.setattr(paths, "IN_A_CLONE", in_a_clone)
    monkeypatch.setattr(machine, "_has_capabilities", lambda: False)
    monkeypatch.setattr(machine, "_limit", lambda _: 0.0)
    return list(machine._real_time())

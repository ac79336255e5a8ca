"""Whatever a viewer says that a field has become, the page goes on with values it could have."""

import math
import time

import msgpack
import pytest
import viser
from many_viewers import CAMERA
from websockets.sync.client import connect

IMPOSSIBLE = [
    math.nan,
    math.inf,
    -math.inf,
    "",
    "None",
    "<b>",
    None,
    [],
    {},
    [1.0],
    b"\xff",
    {"a": 1},
]


@pytest.fixture
def viewer(served):
    """Of a program, which may say anything."""
    protocol = f"viser-v{viser.__version__}"
    address = f"ws://127.0.0.1:{served.get_port()}"
    with connect(address, subprotocols=[protocol], max_size=None) as socket:
        socket.send(msgpack.packb(CAMERA))  # viser counts who has a camera
        yield socket


def say(viewer, field, updates) -> None:
    message = {"type": "GuiUpdateMessage", "uuid": field._impl.uuid, "updates": updates}
    viewer.send(msgpack.packb(message))


def until(condition) -> None:
    end = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_a_text_is_a_line_of_bounded_length(served, viewer):
    field = served.gui.add_text("a", "before")
    for value in [None, 3, 0.5, True, [], {"a": 1}, "x" * 201, "é" * 101, "a\nb", "\x1b[2J", "\0"]:
        say(viewer, field, {"value": value})
    say(viewer, field, {"value": "pick <b>"})
    until(lambda: field.value != "before")
    assert field.value == "pick <b>"


FIELDS = {
    "slider": (lambda gui: gui.add_slider("a", 0.0, 10.0, 0.1, 3.0), [True], 7),
    "dropdown": (lambda gui: gui.add_dropdown("a", ("x", "y")), [1, 0.5, True], "y"),
    "checkbox": (lambda gui: gui.add_checkbox("a", False), [1, 0.5], True),
}


@pytest.mark.parametrize("kind", FIELDS)
def test_what_a_field_cannot_become_is_dropped(served, viewer, kind, capfd):
    make, others, good = FIELDS[kind]
    field = make(served.gui)
    before, seen = field.value, []
    field.on_update(lambda _event: seen.append(field.value))
    for value in [*IMPOSSIBLE, *others]:
        say(viewer, field, {"value": value})
    for updates in (3, [], {}, {"label": "x"}, {"value": good, "uuid": "x"}):
        say(viewer, field, updates)
    say(viewer, field, {"value": good})
    until(lambda: field.value == good)
    until(lambda: seen)
    assert set(seen) == {good} and good != before
    assert field.label == "a"
    assert "Traceback" not in "".join(capfd.readouterr())

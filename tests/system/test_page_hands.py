"""The page in the hands of people: at three sizes, in a fault, with two viewers, with a browser
that stops; what they type and what others change. Asserted on messages and on what can be read
and clicked, not on pixels.
"""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from browser_page import (
    CHROMIUM,
    ROBOT,
    Arm,
    activate,
    drag_goal,
    force,
    free_port,
    launched,
    monitor,
    opened,
    press,
    push_arm,
)
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.lcmtypes.mode_request_t import mode_request_t as Mode
from limber.live.arm import Arm as Client
from limber.live.arm_errors import NoStackError, RecoveryError
from limber.messages import MONITOR_CLIENT
from page_processes import stopped
from stack import ROOT

playwright = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium: ./limber test installs it"),
    pytest.mark.browser,
]

SIZES = {"phone": (390, 844), "small": (1100, 700), "large": (1600, 1000)}
LIFE_S = 1.0  # of a page that draws without a graphics card
SLOW_S = 0.75  # what a busy machine takes to hear and to send


def window(name: str) -> dict:
    width, height = SIZES[name]
    return {"width": width, "height": height}


@pytest.fixture(scope="module")
def driver():
    with playwright.sync_playwright() as driver:
        yield driver


@pytest.fixture(scope="module")
def browser(driver):
    with launched(driver) as browser:
        yield browser


@pytest.fixture(scope="module")
def stack(tmp_path_factory):
    arm = Arm(tmp_path_factory.mktemp("stack"))
    arm.start_all()
    yield arm
    arm.close()


@pytest.fixture(scope="module")
def url():
    with monitor("--control", "--robot", ROBOT) as url:
        yield url


@pytest.fixture(scope="module")
def page(browser, url, stack):
    with opened(browser, url, window("small")) as page:
        page.set_default_timeout(180_000)  # a machine without a graphics card that does more
        page.get_by_role("button", name="STOP").first.wait_for()
        stack.until(lambda: stack.newest("SIM_TRUTH") is not None, "an arm", 180.0)
        yield page


@pytest.fixture
def active(page, stack):
    activate(page, stack)


@pytest.fixture
def client(stack, url):
    """A script with the page's lease, so that both may command."""
    arm = reached(MONITOR_CLIENT + int(url.rsplit(":", 1)[1]))
    yield arm
    arm.detach()


@pytest.fixture
def at_home(page, stack):
    stack.start_anew()
    activate(page, stack)


def reached(number: int) -> Client:
    """A machine that also draws is slow to be heard."""
    for _ in range(30):
        try:
            return Client(client=number)
        except NoStackError:
            time.sleep(0.2)
    raise AssertionError("no stack")


def button(page, word: str):
    return page.get_by_role("button", name=word, exact=True)


def arm_time_s(stack) -> float:
    return float(stack.newest("JOINT_STATE")["time_ns"]) * 1e-9


def break_drive(stack, kind: str = "silent", for_s: float = 0.3) -> float:
    """A fault; returns the arm time at which its cause is gone."""
    entry = f"fault: {{joint: joint3, kind: {kind}, for_s: {for_s}}}"
    command = [sys.executable, "-m", "limber", "send", "--robot", ROBOT, entry]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    stack.until(lambda: stack.mode == Status.MODE_FAULT, "the fault")
    return arm_time_s(stack) + for_s + 0.3


def wait_arm_time(stack, end_s: float) -> None:
    stack.until(lambda: arm_time_s(stack) > end_s, "arm time to pass", 120.0)


LOOK = """() => [...document.querySelectorAll("button[data-limber]")].map(button => {
  const box = button.getBoundingClientRect();
  const over = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
  const seen = over === button && box.top >= 0 && box.bottom <= innerHeight;
  return [button.dataset.limber, box.x, seen, button.disabled];
})"""


def buttons(page) -> dict[str, tuple[float, bool, bool]]:
    """Of the box: place, seen without scrolling and with nothing over it, disabled."""
    return {word: (x, seen, disabled) for word, x, seen, disabled in page.evaluate(LOOK)}


@pytest.fixture(params=SIZES)
def size(request, page, stack):
    activate(page, stack)  # before: a touch on a telephone's panel folds it
    page.set_viewport_size(window(request.param))
    yield SIZES[request.param]
    page.set_viewport_size(window("small"))


def test_a_fault_is_left_by_the_buttons_of_its_box(stack, page, size, client):
    """In the order of the way there; each waits until it can act."""
    gone_s = break_drive(stack)
    box = page.locator("div", has=page.get_by_text("FAULT", exact=True)).filter(
        has=button(page, "acknowledge")
    )
    box.filter(has_text="driver.REPLY_LOST (joint3)").filter(has_text="To do:").last.wait_for()

    def laid_out() -> bool:
        """A box without the buttons is that of a stack that is not heard: this machine is busy."""
        found = buttons(page)
        way = [found.get(word) for word in ("acknowledge", "hold", "active")]
        if None in way or not all(seen for _, seen, _ in way):
            return False
        from_left = sorted(way) == way
        return from_left and [disabled for _, _, disabled in way] == [False, True, True]

    stack.until(laid_out, "acknowledge, hold, active, seen, the first of them enabled")
    width, height = size

    def room() -> bool:
        canvas = page.locator("canvas").first.bounding_box()
        if width >= 700:
            return canvas["width"] >= 0.5 * width
        return canvas["height"] >= 0.3 * height and canvas["width"] == width

    stack.until(room, "half of the window for the arm, or a third of a telephone's")
    wait_arm_time(stack, gone_s)
    for word, mode in (("acknowledge", "IDLE"), ("hold", "HOLD"), ("active", "ACTIVE")):
        wanted = getattr(Status, f"MODE_{mode}")
        end = time.monotonic() + 60
        while stack.mode != wanted and time.monotonic() < end:
            press(page, word)
            time.sleep(0.5)
        assert stack.mode == wanted
    page.locator('button[aria-current="true"]', has_text="active").wait_for()


TALLEST_LABEL = """() => Math.max(...[...document.querySelectorAll("label[for]")].map(label =>
  label.getBoundingClientRect().height / parseFloat(getComputedStyle(label).lineHeight)))"""


def test_labels_are_two_lines_at_most(page):
    for tab, label in (("push", "at most N"), ("view", "forces"), ("control", "damping ratio")):
        page.get_by_role("tab", name=tab).click()
        page.get_by_text(label, exact=True).first.wait_for(timeout=30_000)
        assert 0.9 < page.evaluate(TALLEST_LABEL) < 2.1, tab


def test_recover_goes_the_way_and_names_where_it_stops(stack, page, client):
    activate(page, stack)
    gone_s = break_drive(stack, for_s=10.0)
    with pytest.raises(RecoveryError, match=r"stopped at '(acknowledge|hold)'.* in ") as failed:
        client.recover(timeout_s=8.0)
    assert failed.value.step in ("acknowledge", "hold")
    wait_arm_time(stack, gone_s)
    client.recover(timeout_s=30.0)
    stack.until(lambda: stack.mode == Status.MODE_ACTIVE, "ACTIVE")
    wait_arm_time(stack, break_drive(stack, "drive_error"))
    with pytest.raises(RecoveryError, match=r"stopped at 'hold'.*release=True"):
        client.recover(timeout_s=30.0, release=False)
    client.recover(timeout_s=30.0)
    stack.until(lambda: stack.mode == Status.MODE_ACTIVE, "ACTIVE")
    client.release()


def test_limber_send_recover_does_it_all(stack, page, client):
    client.hold()  # the lease is the page's, whoever had it before
    activate(page, stack)
    wait_arm_time(stack, break_drive(stack))
    client.release()
    command = [sys.executable, "-m", "limber", "send"]
    done = subprocess.run([*command, "recover"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "active" in done.stdout
    stack.until(lambda: stack.mode == Status.MODE_ACTIVE, "ACTIVE, which stays")
    subprocess.run([*command, "mode: release"], cwd=ROOT, check=True)


def test_gains_sent_in_a_fault_are_shown_beside_those_in_effect(stack, page, client):
    activate(page, stack)
    client.soften(300)
    gone_s = break_drive(stack)
    client.gains(K_x_translation_N_per_m=900)
    page.get_by_text("K_x_translation_N_per_m: 900 (now 300)").wait_for()
    page.get_by_text("With active; now 300 N/m.").wait_for()
    wait_arm_time(stack, gone_s)
    activate(page, stack)
    page.get_by_text("K_x_translation_N_per_m: 900").wait_for(state="hidden")
    stack.until(lambda: abs(stack.status["K_x"][0][0] - 900) < 1, "900 N/m in effect")


def test_what_another_client_sets_an_axis_each_is_shown_an_axis_each(stack, page, client, active):
    client.gains(K_x_translation_N_per_m=[333, 222, 111])
    page.get_by_text("333 / 222 / 111 N/m; this slider sets all alike").wait_for()


def field(page):
    """Of the first slider, K_x of the translation."""
    return page.locator("input.mantine-NumberInput-input:visible").first


def type_in(page, text: str) -> None:
    field(page).click()
    page.keyboard.type(text)
    page.keyboard.press("Enter")


def sent_stiffness(stack) -> list[float]:
    return [float(np.diag(message.K_x)[0]) for message in stack.sent["COMPLIANCE_GAINS"]]


def test_what_is_typed_is_sent_rounded_or_refused_and_that_is_told(stack, page, client, active):
    client.soften(300)
    stack.sent["COMPLIANCE_GAINS"].clear()
    refused = {"-5": "-5 is not within 0", "1e9": "1e9 is not within", "3,5": "'3,5' is no number"}
    for text, told in refused.items():
        type_in(page, text)
        page.get_by_text(told).first.wait_for()
    assert sent_stiffness(stack) == [], "nothing was sent of it"
    type_in(page, "0")
    stack.until(lambda: sent_stiffness(stack) == [0.0], "0 to be sent")
    type_in(page, "1234.5678")
    stack.until(lambda: len(sent_stiffness(stack)) == 2, "the next to be sent")
    page.get_by_text("1234.5678 was rounded to 1234.568").first.wait_for()
    assert sent_stiffness(stack) == [0.0, 1234.568], "no digit is sent before the last"


def test_a_field_with_the_focus_is_not_overwritten(stack, page, client, active):
    field(page).click()
    page.keyboard.type("45")
    client.soften(777)
    stack.until(lambda: field(page).input_value() == "777", "the page to follow behind it")
    page.keyboard.type("6")
    stack.sent["COMPLIANCE_GAINS"].clear()
    page.keyboard.press("Enter")
    stack.until(lambda: 456.0 in sent_stiffness(stack), "456 to be sent")


def pushes_after(stack, begin_s: float) -> list:
    """Those that push, by their sender's clock, which is this machine's."""
    return [
        push for push in stack.sent["PUSH"] if push.time_ns * 1e-9 > begin_s and np.any(push.wrench)
    ]


def assert_over(stack, begin_s: float) -> None:
    """Nothing refreshes the push once its browser is silent, and none outlives it."""
    time.sleep(2.5)
    late = [p.time_ns * 1e-9 - begin_s for p in pushes_after(stack, begin_s + LIFE_S + SLOW_S)]
    assert late == [], "pushes that nobody makes any more"
    stack.until(lambda: force(stack) == 0.0, "the end of the push")


@pytest.mark.parametrize("kind", ["browser", "renderer", "all"])
def test_a_push_ends_when_its_browser_stops(stack, page, at_home, kind):
    """Of the processes of a browser each is needed for a hand to be a hand."""
    push_arm(page, stack)
    try:
        with stopped(kind):
            assert_over(stack, time.monotonic())
    finally:
        page.mouse.up()


@pytest.mark.parametrize("how", ["close", "reload"])
def test_a_push_ends_with_its_page(stack, url, page, browser, at_home, how):
    """The other viewer's signs of life do not keep it."""
    with opened(browser, url, window("small")) as other:
        button(other, "hold").wait_for()
        push_arm(other, stack)
        begin_s = time.monotonic()
        if how == "close":
            other.close()
        else:
            other.reload(wait_until="commit")
        begin_s = max(begin_s, time.monotonic() - LIFE_S)
        assert_over(stack, begin_s)


def test_a_push_ends_with_the_monitor(stack, browser, at_home):
    port = free_port()
    command = [sys.executable, "-m", "limber", "monitor", "--control", "--port", str(port)]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        address = next(line for line in process.stdout if "http://" in line).split()[0]
        with opened(browser, address, window("small")) as page:
            button(page, "hold").or_(button(page, "active")).first.wait_for()
            push_arm(page, stack)
            process.send_signal(signal.SIGKILL)
            begin_s = time.monotonic()
            time.sleep(0.05)
            assert pushes_after(stack, begin_s + 0.05) == []
            stack.until(lambda: force(stack) == 0.0, "the end of the push")
            page.mouse.up()
    finally:
        process.kill()
        process.wait()


def test_a_motion_ends_at_its_last_goal_when_its_page_is_closed(stack, url, page, browser, at_home):
    """In the middle of a drag; the law runs on, and the other viewer has the arm."""
    start = stack.status["p_BD"].copy()
    with opened(browser, url, window("small")) as other:
        button(other, "hold").wait_for()
        drag_goal(other, stack, let_go=False)
        stack.until(lambda: np.linalg.norm(stack.status["p_BD"] - start) > 0.02, "a motion")
    before = np.full(3, np.nan)

    def rests() -> bool:
        nonlocal before
        goal, before = before, stack.status["p_BD"].copy()
        wait_arm_time(stack, arm_time_s(stack) + 0.3)
        return bool(np.allclose(goal, before, atol=1e-5))

    stack.until(rests, "the goal to rest")
    assert stack.mode == Status.MODE_ACTIVE
    assert np.linalg.norm(before - start) < 0.3
    press(page, "hold")
    stack.until(lambda: stack.mode == Status.MODE_HOLD, "hold, by the other viewer")


def test_anybody_stops_the_arm(stack, browser, url, page, client, active):
    """A page of another monitor: without --control and without the lease, not even in front."""
    with monitor("--robot", ROBOT) as reader, opened(browser, reader, window("phone")) as other:
        stop = other.get_by_role("button", name="STOP").first
        stop.wait_for()
        assert button(other, "hold").count() == 0, "it shows, and can stop"
        page.bring_to_front()
        before = len(stack.sent["MODE_REQUEST"])
        other.evaluate(PRESS, "hold")
        stop.evaluate("button => button.click()")
        stack.until(lambda: stack.mode in (Status.MODE_SOFT_STOP, Status.MODE_HOLD), "a stop")
        asked = {message.request for message in stack.sent["MODE_REQUEST"][before:]}
        assert asked <= {Mode.REQUEST_STOP}, "its page asks for no other mode"
        other.get_by_text("STOP: taken by the controller").first.wait_for()
    activate(page, stack)
    client.hold()
    page.get_by_text("STOP: taken").wait_for(state="hidden")


PRESS = """word => new Promise(done => {
  const socket = new WebSocket(location.origin.replace("http", "ws"), "limber-page");
  const message = JSON.stringify({viewer: 0, kind: "press", value: word});
  socket.onopen = () => { socket.send(message); done(); };
})"""


def test_the_page_draws_no_more_often_than_the_machine_bears(page):
    """Without a graphics card, which no test has: 5 times a second, at half the resolution."""
    count = """() => new Promise(done => {
      const begun = performance.now();
      let frames = 0;
      const draw = () => {
        ++frames;
        if (performance.now() - begun < 3000) requestAnimationFrame(draw);
        else done(frames);
      };
      requestAnimationFrame(draw);
    })"""
    assert 1 <= page.evaluate(count) <= 3 * 5 + 2
    scale = "canvas => canvas.width / canvas.clientWidth"
    assert page.locator("canvas[data-engine]").evaluate(scale) == pytest.approx(0.5, abs=0.01)
    assert page.get_by_text("Software WebGL rendering detected").is_visible() is False
    note = page.get_by_text("drawn 5 times a second")
    assert note.bounding_box()["height"] < 24, "one line"

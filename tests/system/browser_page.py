"""`limber monitor` in a headless browser, with a stack behind it: for tests and for pictures.

The stack runs in lock step at the clock's pace, and behind the browser: drawing without a graphics
card takes all the processor that a control loop in real time would need.
"""

import shutil
import socket
import subprocess
import sys
import threading
import time
from collections import defaultdict
from contextlib import closing, contextmanager, suppress
from io import BytesIO

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from limber import messages
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from limber.live.receiver import Receiver
from limber.model.robot import load_robot
from limber.monitor.live_feed import LiveFeed
from limber.monitor.scene import camera
from limber.monitor.shapes import figure
from stack import BIN, ROOT

CHROMIUM = shutil.which("chromium")
# Other flags than these draw ten times slower without a graphics card.
FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"]
SIZE = {"width": 1200, "height": 660}
ROBOT = "openarm"
FOV = np.radians(75)  # vertical, the page's default


class Arm:
    """The three processes, and what they and the page have sent."""

    def __init__(self, directory, robot: str = ROBOT) -> None:
        self.directory, self.robot, self.feed = directory, robot, LiveFeed()
        self._requests = Receiver("PUSH", "MODE_REQUEST")
        self._streams = {name: self._requests.stream(name) for name in self._requests.channels}
        self.processes: dict[str, subprocess.Popen] = {}
        self.sent = defaultdict(list)
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        while not self._end.wait(0.02):
            for name, found in self.feed.take().objects.items():
                self.sent[name] += found
            for name, stream in self._streams.items():
                kind = self._requests.channels[name].type_name
                self.sent[name] += [messages.decode(kind, data) for data in stream.raw()]

    def start(self, name: str, *arguments: str) -> None:
        command = ["nice", "-n", "19", BIN / f"limber-{name}", "--robot", self.robot, *arguments]
        with open(self.directory / f"{name}.log", "a", encoding="utf-8") as log:
            self.processes[name] = subprocess.Popen(command, stdout=log, stderr=log)

    def start_all(self) -> None:
        self.start("sim", "--paced")
        self.start("controller", "--paced")
        time.sleep(0.5)
        self.start("driver", "--paced")

    def start_anew(self) -> None:
        """At home again, where nothing covers the arm."""
        for name in self.processes:
            self.kill(name)
        self.start_all()
        self.until(lambda: self.newest("JOINT_STATE")["time_ns"] < 1_000_000_000, "a new run")

    def newest(self, channel: str):
        return self.feed.newest.get(channel)

    @property
    def status(self):
        return self.newest("CONTROLLER_STATUS")

    @property
    def mode(self) -> int | None:
        return None if self.status is None else int(self.status["mode"])

    def until(self, condition, what: str, seconds: float = 60.0) -> None:
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"waited {seconds:g} s in vain for: {what}"
            time.sleep(0.02)

    def kill(self, name: str) -> None:
        self.processes[name].kill()
        self.processes[name].wait()

    def close(self) -> None:
        for name in self.processes:
            self.kill(name)
        self._end.set()
        self._thread.join()
        self.feed.close()
        self._requests.close()


def free_port() -> int:
    with closing(socket.socket()) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextmanager
def monitor(*arguments: str):
    """The address of a page that is being served."""
    port = free_port()
    command = [sys.executable, "-m", "limber", "monitor", "--port", str(port), *arguments]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    try:
        assert "http://" in process.stdout.readline()
        yield f"http://127.0.0.1:{port}"
    finally:
        process.terminate()
        assert process.wait(timeout=300) == 0


@contextmanager
def launched(driver):
    browser = driver.chromium.launch(executable_path=CHROMIUM, headless=True, args=FLAGS)
    try:
        yield browser
    finally:
        browser.close()


@contextmanager
def opened(browser, url: str, size: dict = SIZE):
    """A page; none of its requests leaves the machine."""
    page, outside = browser.new_page(viewport=size), []
    page.set_default_timeout(60_000)
    local = (url, "data:", "blob:")
    page.on("request", lambda r: None if r.url.startswith(local) else outside.append(r.url))
    try:
        page.goto(url)
        yield page
    finally:
        page.close()  # one that is left draws on and slows the tests after it
    assert outside == []


def press(page, word: str) -> None:
    """A button of the box. One that cannot act any more, since the mode has changed meanwhile, is
    not waited for.
    """
    from playwright.sync_api import TimeoutError as InVain

    with suppress(InVain):
        page.get_by_role("button", name=word, exact=True).click(timeout=5_000)


def activate(page, stack: Arm) -> None:
    """ACTIVE, by the page's own buttons."""
    page.get_by_text("limber ·").first.click()  # no field has the focus

    def there() -> bool:
        if stack.mode == Status.MODE_ACTIVE:
            return page.get_by_text("ACTIVE", exact=True).first.is_visible()
        faulty = stack.mode in (Status.MODE_FAULT, Status.MODE_ESTOP)
        onward = "active" if stack.mode == Status.MODE_HOLD else "hold"
        press(page, "acknowledge" if faulty else onward)
        time.sleep(0.5)
        return False

    stack.until(there, "ACTIVE, by the buttons, and shown", 120.0)


def screen(page, point: np.ndarray) -> tuple[float, float]:
    """Where a point in the base frame is seen, as long as nobody has moved the camera."""
    robot = load_robot(ROBOT)
    eye = camera(robot, figure(robot))
    z = (eye.look_at - eye.position) / np.linalg.norm(eye.look_at - eye.position)
    x = np.cross(z, eye.up) / np.linalg.norm(np.cross(z, eye.up))
    away = np.asarray(point) - eye.position
    box = page.locator("canvas").first.bounding_box()
    scale = 0.5 * box["height"] / np.tan(0.5 * FOV) / (away @ z)
    middle = box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]
    return middle[0] + scale * (away @ x), middle[1] - scale * (away @ np.cross(x, z))


def drag(page, start: tuple, end: tuple, hold_s: float = 0.0, let_go: bool = True) -> None:
    page.mouse.move(*start)
    time.sleep(0.3)  # the page has to see what is under the pointer
    page.mouse.down()
    for share in np.linspace(0.1, 1.0, 10):
        page.mouse.move(*(a + share * (b - a) for a, b in zip(start, end, strict=True)))
        time.sleep(0.05)
    time.sleep(hold_s)
    if let_go:
        page.mouse.up()


def drawn(page, point: tuple) -> bool:
    """Something darker or more colourful than the ground is near that point of the window."""
    clip = {"x": point[0] - 40, "y": point[1] - 40, "width": 80, "height": 80}
    image = Image.open(BytesIO(page.screenshot(clip=clip))).convert("RGB")
    return np.asarray(image).min() < 100


def settled(where, also=lambda _place: True) -> tuple[float, float]:
    """A place of the window, once it stays: panels take their width, and lines come and go."""
    end, before = time.monotonic() + 120.0, (np.nan, np.nan)
    while True:
        place = where()
        if np.allclose(place, before, atol=1.0) and also(place):
            return place
        assert time.monotonic() < end, f"nothing rests, or is drawn, at {place}"
        before = place
        time.sleep(1.0)


def held(page, place: tuple) -> bool:
    """The pointer's shape shows that what is under it can be dragged: before, the camera would
    be.
    """
    page.mouse.move(place[0] + 2, place[1])
    page.mouse.move(*place)
    there = "place => getComputedStyle(document.elementFromPoint(...place)).cursor"
    return page.evaluate(there, list(map(float, place))) == "pointer"


def upper_arm(page, stack) -> tuple[float, float]:
    """Its middle on the screen."""
    made, X, places = figure(load_robot(ROBOT)), np.eye(4), []
    for joint, X_PF, q in zip(
        made.joints, made.X_PF, stack.newest("JOINT_STATE")["q"], strict=False
    ):
        turn = np.eye(4)
        turn[:3, :3] = Rotation.from_rotvec(q * joint.axis).as_matrix()
        X = X @ X_PF @ turn
        places.append(X[:3, 3])
    return screen(page, 0.5 * (places[2] + places[3]))


def push_arm(page, stack) -> None:
    """By its upper arm, which the pointer holds on to."""
    x, y = settled(lambda: upper_arm(page, stack), lambda place: held(page, place))
    drag(page, (x, y), (x + 60, y - 30), let_go=False)
    stack.until(lambda: force(stack) > 2.0, "a push")


def force(stack) -> float:
    """N, on the simulated arm."""
    return float(np.linalg.norm(stack.newest("SIM_TRUTH")["F_push"][:3]))


def drag_goal(page, stack, let_go: bool = True) -> np.ndarray:
    """By the gizmo's first arrow, 8 cm; returns the arrow's direction in the base frame."""
    status = stack.status
    R = Rotation.from_quat(status["quat_BD"], scalar_first=True)
    axis, grip = R.apply([1.0, 0.0, 0.0]), 0.28 * figure(load_robot(ROBOT)).reach_m
    p = status["p_BD"].copy()
    begin, end = screen(page, p + grip * axis), screen(page, p + (grip + 0.08) * axis)
    way = end[0] - begin[0], end[1] - begin[1]
    start = settled(lambda: screen(page, p + grip * axis), lambda place: drawn(page, place))
    drag(page, start, (start[0] + way[0], start[1] + way[1]), let_go=let_go)
    return axis

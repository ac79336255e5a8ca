"""The web page in a real browser: what it shows, and what its clicks and drags do to the arm.

Everything is asserted on the messages, not on pixels.
"""

import shutil
import subprocess
import time

import numpy as np
import pytest

from browser_page import (
    CHROMIUM,
    ROBOT,
    Arm,
    activate,
    drag,
    drag_goal,
    force,
    launched,
    monitor,
    opened,
    push_arm,
    settled,
)
from limber.lcmtypes.controller_status_t import controller_status_t as Status
from stack import BIN, ROOT

playwright = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium: ./limber test installs it"),
]


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as driver, launched(driver) as browser:
        yield browser


@pytest.fixture(scope="module")
def stack(tmp_path_factory):
    arm = Arm(tmp_path_factory.mktemp("stack"))
    yield arm
    arm.close()


@pytest.fixture(scope="module")
def page(browser, stack):
    """With control; it finds the stack, which is started later, by itself."""
    with monitor("--control", "--robot", ROBOT) as url, opened(browser, url) as page:
        page.get_by_text("NO STACK").wait_for()
        stack.start_all()
        yield page


@pytest.fixture
def active(page, stack):
    activate(page, stack)


def middle_of(locator) -> tuple[float, float]:
    box = locator.bounding_box()
    return box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]


def test_a_slider_makes_the_arm_stiffer(page, stack, active):
    middle = settled(lambda: middle_of(page.get_by_role("slider").nth(0)))
    drag(page, middle, (middle[0] + 40, middle[1]))

    def stiffness() -> np.ndarray:
        sent = stack.sent["COMPLIANCE_GAINS"]
        return np.diag(sent[-1].K_x) if sent else np.zeros(6)

    stack.until(lambda: stiffness()[0] > 520, "a stiffer K_x")
    stack.until(lambda: stack.status["K_x"][0][0] > 520, "K_x in effect")
    assert np.ptp(stiffness()[:3]) == 0, "one slider sets all three axes"


def test_the_gizmo_moves_the_goal(page, stack, active):
    p = stack.status["p_BD"].copy()
    axis = drag_goal(page, stack)
    stack.until(lambda: (stack.status["p_BD"] - p) @ axis > 0.04, "the goal along the axis")
    moved = stack.status["p_BD"] - p
    assert np.linalg.norm(moved - (moved @ axis) * axis) < 0.01
    assert stack.mode == Status.MODE_ACTIVE


def test_a_dragged_link_is_pushed_until_it_is_let_go(page, stack, active):
    push_arm(page, stack)
    time.sleep(1.5)
    stack.until(lambda: force(stack) > 2.0, "the push, refreshed while the pointer rests")
    assert force(stack) <= 30.1, "bounded by the slider on the page"
    page.mouse.up()
    time.sleep(0.5)
    stack.until(lambda: force(stack) == 0.0, "the end of the push")


@pytest.mark.parametrize("how", ["button", "floating", "space"])
def test_stop(page, stack, active, how):
    if how == "space":
        page.keyboard.press("Space")
    else:
        buttons = page.get_by_role("button", name="STOP")
        (buttons.first if how == "button" else buttons.last).click()
    stack.until(lambda: stack.mode in (Status.MODE_SOFT_STOP, Status.MODE_HOLD), "a stop")
    page.get_by_text("taken by the controller").wait_for()


def test_a_dead_stack_is_shown_and_comes_back(page, stack, active):
    stack.kill("controller")
    dead = page.get_by_text("What is shown is old").first
    dead.wait_for()
    stack.start("controller", "--lockstep")
    dead.wait_for(state="hidden")


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    for name in ("robot.yaml", "robot.urdf"):
        shutil.copy(ROOT / "robots" / ROBOT / name, folder)
    scenario = ROOT / "scenarios" / "demo_short.yaml"
    shutil.copy(scenario, folder / "scenario.yaml")
    command = [BIN / "limber-lab", scenario, "--log", folder / "run.lcmlog"]
    subprocess.run(command, check=True, capture_output=True)
    return folder


def place(page) -> float:
    """In the log, s."""
    return float(page.locator("input.mantine-NumberInput-input:visible").first.input_value())


def test_a_log_jumps_and_plays(browser, run_folder):
    with monitor(str(run_folder)) as url, opened(browser, url) as page:
        page.get_by_role("button", name="play", exact=True).wait_for()
        assert place(page) == 0.0
        start = settled(lambda: middle_of(page.get_by_role("slider").first))
        drag(page, start, (start[0] + 60, start[1]))
        time.sleep(1.0)
        there = place(page)
        assert there > 0.3
        page.get_by_text("ACTIVE", exact=True).wait_for()
        page.get_by_role("button", name="play", exact=True).click()
        end = time.monotonic() + 30
        while place(page) <= there and time.monotonic() < end:
            time.sleep(0.1)
        assert place(page) > there
        assert page.get_by_text("STOP").count() == 0, "a log cannot be stopped"

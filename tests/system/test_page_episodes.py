"""The page beside an arm with a hand and a recorder: the hand's sliders, and episodes by button."""

import pytest

from browser_page import CHROMIUM, Arm, activate, drag, launched, monitor, opened, settled
from limber.log.episodes import episodes
from limber.log.reader import Log
from recorders import recording

playwright = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium: ./limber test installs it"),
]
ROBOT = "openarm_right"


@pytest.fixture
def stack(tmp_path):
    arm = Arm(tmp_path, ROBOT)
    arm.start_all()
    yield arm
    arm.close()


def tab(page, name: str) -> None:
    page.get_by_role("tab", name=name).click()


def test_the_hand_moves_and_an_episode_is_marked(stack, tmp_path):
    path = tmp_path / "run.lcmlog"
    with (
        playwright.sync_playwright() as driver,
        launched(driver) as browser,
        monitor("--control", "--robot", ROBOT) as url,
        opened(browser, url) as page,
        recording(path) as recorder,
    ):
        activate(page, stack)
        tab(page, "episodes")
        page.locator(".mantine-TextInput-input:visible").first.fill("close the hand")
        page.get_by_role("button", name="start", exact=True).click()
        page.get_by_text("episode (close the hand) runs").wait_for()
        tab(page, "hand")

        def place() -> tuple[float, float]:
            box = page.get_by_role("slider").locator("visible=true").first.bounding_box()
            return box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]

        start = settled(place)
        drag(page, start, (start[0] - 40, start[1]))

        def state(name: str) -> float:
            return float(stack.newest("HAND_STATE")[name])

        stack.until(lambda: 0.0 < state("goal_width_m") < 0.075, "a goal of the hand")
        stack.until(lambda: abs(state("width_m") - state("goal_width_m")) < 2e-3, "the hand there")
        tab(page, "episodes")
        page.get_by_role("button", name="success", exact=True).click()
        page.get_by_text("ended: success").wait_for()
        recorder.terminate()
        assert recorder.wait(timeout=300) == 0
    (one,) = episodes(Log(path))
    assert (one.task, one.outcome, one.dropped) == ("close the hand", "success", False)

"""Draws the pictures of docs/monitor.md: `.venv/bin/python tests/system/monitor_pictures.py docs`,
in a network that carries multicast and no other stack.
"""

import sys
import tempfile
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

from browser_page import ROBOT, Arm, activate, drag, launched, monitor, opened, upper_arm

SIZE = {"width": 1600, "height": 900}


def shoot(page, path: Path) -> None:
    page.screenshot(path=path)
    print(path, path.stat().st_size // 1000, "kB")


def pushed_arm(browser, path: Path) -> None:
    stack = Arm(Path(tempfile.mkdtemp()))
    try:
        with monitor("--control", "--robot", ROBOT) as url, opened(browser, url, SIZE) as page:
            page.goto(f"{url}/?fixedDpr=1")  # the whole resolution, though drawn by the processor
            stack.start_all()
            activate(page, stack)
            page.get_by_role("combobox", name="show").click()
            page.get_by_text("tip", exact=True).click()
            time.sleep(3.0)
            start = upper_arm(page, stack)
            drag(page, start, (start[0] + 110, start[1] - 60), hold_s=3.0, let_go=False)
            shoot(page, path)
            page.mouse.up()
    finally:
        stack.close()


def main(folder: Path) -> None:
    with sync_playwright() as driver, launched(driver) as browser:
        pushed_arm(browser, folder / "monitor.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]))

"""plot.html in a real browser: it draws what it holds, and no name becomes markup."""

import numpy as np
import pytest

from browser_page import CHROMIUM, launched
from limber.plot import page
from limber.plot.chart import Chart
from limber.plot.drawing import Drawing
from limber.plot.marks import Mark, Span

playwright = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium: ./limber test installs it"),
    pytest.mark.browser,
]

EVIL = "<img src=x onerror=alert(1)></script><script>alert(2)</script>"


def drawing() -> Drawing:
    t = np.arange(500) * 0.01
    wave = np.sin(t)
    way = np.concatenate([np.linspace(0, 20, 100), np.linspace(20, 5, 100)])
    loop = Chart("push", "N", way, {EVIL: np.abs(way - 3)}, x="displacement (mm)", loop=True)
    rest = Chart("velocity", "rad/s", t, {EVIL: 1e-4 * wave}, least=0.05)
    stack = Chart("torque", "N m", t, {"a": wave, "sent": wave + 1}, stacked={"a"}, least=0.5)
    tail = Chart("share", "1", np.geomspace(1, 100, 50), {"b": np.geomspace(1, 1e-3, 50)}, log=True)
    tail.x = "time (µs)"
    topics = {"overview": [rest, loop], "torque": [stack], "timing": [tail]}
    events = [Mark(1, 1.0, EVIL, True), Mark(2, 2.0, "mode ACTIVE", False)]
    return Drawing(EVIL, topics, events, [Span(0.0, 0.5, False)], constant={"overview": [EVIL]})


def test_it_draws_and_no_name_becomes_markup(tmp_path):
    file = tmp_path / "plot.html"
    page.save(drawing(), file)
    with playwright.sync_playwright() as driver, launched(driver) as browser:
        shown, wrong = browser.new_page(viewport={"width": 1100, "height": 700}), []
        shown.on("pageerror", lambda error: wrong.append(str(error)))
        shown.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
        shown.goto(file.as_uri())
        assert shown.locator("main .u-wrap").count() == 2
        assert shown.get_by_text("constant, not drawn").inner_text().endswith(EVIL)
        assert shown.locator("main img").count() == 0
        inked = """() => [...document.querySelectorAll("main canvas")].map(canvas => {
          const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
          let blue = 0;
          for (let i = 0; i < data.length; i += 4)
            if (data[i] < 60 && data[i + 2] > 120 && data[i + 3] > 100) ++blue;
          return blue;
        })"""
        assert min(shown.evaluate(inked)) > 100, "each chart has its line"
        for topic in ("torque", "timing", "overview"):
            shown.get_by_role("button", name=topic, exact=True).click()
            assert shown.locator("main .u-wrap").count() >= 1
        shown.locator("main .u-over").first.hover()
        assert wrong == []

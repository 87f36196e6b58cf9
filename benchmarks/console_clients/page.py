"""The console's page in Chromium: the frames that it draws, and clicks on its stop button."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from console_clients import chromium as browser_program
from console_clients.figures import quantiles

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

    from console_clients.console_process import Console
    from console_clients.viewers import Viewer

PAGE_TIMEOUT_S = 5.0
"""Maximum time in seconds for a click on the page, or for reading its records. If it takes longer, it counts as a failure."""

WATCH_PAGE = """
window.scope = { drawn: [], stops: [] };
const parse = JSON.parse;
let facts = null, clicked = 0;
JSON.parse = function (...given) {
  const value = parse.apply(this, given);
  if (value && value.taken && value.pose) facts = value;
  return value;
};
const draw = CanvasRenderingContext2D.prototype.drawImage;
CanvasRenderingContext2D.prototype.drawImage = function (...given) {
  draw.apply(this, given);
  if (!this.canvas.classList.contains("picture") || !facts) return;
  const now = performance.timeOrigin + performance.now();
  window.scope.drawn.push([now / 1000, now / 1000 - facts.taken, facts.number]);
};
addEventListener("click", () => { clicked = performance.now(); }, true);
const ask = window.fetch;
window.fetch = async function (...given) {
  const reply = await ask.apply(this, given);
  if (String(given[0]).endsWith("/stop")) window.scope.stops.push([(performance.now() - clicked) / 1000, reply.status]);
  return reply;
};
"""
"""A script that records in the page when each frame was drawn and its age, and the time from a click to the reply to ``stop``."""

TAKE_RECORDS = "() => { const records = window.scope; window.scope = { drawn: [], stops: [] }; return records; }"


@contextmanager
def chromium() -> Iterator[Browser]:
    """Return a context with a running Chromium."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_program.PROGRAM, args=list(browser_program.ARGUMENTS))
        try:
            yield browser
        finally:
            browser.close()


def open_page(browser: Browser, console: Console, camera: str) -> Page:
    """Open the console's page and select a camera."""
    page = browser.new_page(viewport={"width": 1280, "height": 720})
    page.set_default_timeout(30_000)
    page.add_init_script(WATCH_PAGE)
    page.goto(console.root)
    page.wait_for_selector(".stage[data-fps]")
    page.select_option("select.camera", camera)
    return page


def read_page(page: Page) -> dict[str, list[list[float]]]:
    """Return the records of ``WATCH_PAGE`` since the last call.

    Raises:
        playwright.sync_api.TimeoutError: The page did not answer within ``PAGE_TIMEOUT_S``.
    """
    # Unlike evaluate(), wait_for_function() has a time limit.
    records: dict[str, list[list[float]]] = page.wait_for_function(TAKE_RECORDS, timeout=1000 * PAGE_TIMEOUT_S).json_value()
    return records


@dataclass
class Clicks:
    """Clicks on the page's stop button.

    Attributes:
        replies: For each reply to ``stop``, the seconds since the click and the status code.
        taken_s: For each click, the seconds that the browser took to make it.
        failures: The reason for each failure to click or to read the page.
    """

    replies: list[list[float]] = field(default_factory=list)
    taken_s: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)

    def stop(self, page: Page) -> None:
        """Click the stop button. If it cannot be clicked within ``PAGE_TIMEOUT_S``, record the reason."""
        from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

        began_s = time.perf_counter()
        try:
            page.locator(".stop").click(timeout=1000 * PAGE_TIMEOUT_S)
            self.taken_s.append(time.perf_counter() - began_s)
        except PlaywrightTimeoutError as error:
            self.failures.append(reason(str(error)))

    def read(self, page: Page, viewer: Viewer) -> None:
        """Read the replies to the clicks and the frames that the page has drawn. If the page does not answer, record a failure."""
        from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

        try:
            records = read_page(page)
        except PlaywrightTimeoutError:
            self.failures.append(f"The page's scripts did not run for {PAGE_TIMEOUT_S:g} s.")
            return
        self.replies += records["stops"]
        viewer.arrivals_s += [at for at, _, _ in records["drawn"]]
        viewer.ages_s += [age for _, age, _ in records["drawn"]]
        numbers = [number for _, _, number in records["drawn"]]
        viewer.out_of_order += sum(b <= a for a, b in itertools.pairwise(numbers))

    def results(self) -> dict[str, Any]:
        """Return the number of clicks and of failures, the reasons, and quantiles of the times in seconds."""
        return {
            "clicks": len(self.taken_s) + len(self.failures),
            "failed": len(self.failures),
            "reasons": sorted(set(self.failures)),
            "click_s": quantiles(self.taken_s) if self.taken_s else None,
            "reply_s": quantiles([seconds for seconds, _ in self.replies]) if self.replies else None,
            "statuses": sorted({int(status) for _, status in self.replies}),
        }


def reason(message: str) -> str:
    """Return the last obstacle that Playwright's message about a failed click states."""
    lines = [line.strip(" -") for line in message.splitlines()]
    obstacles = [line for line in lines if "intercepts pointer events" in line or line.startswith("element is ")]
    stable = "element is visible, enabled and stable"
    return next((line for line in reversed(obstacles) if line != stable), lines[0])

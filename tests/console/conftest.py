"""The console in a separate process, and Chromium."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import httpx2
import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, expect, sync_playwright

from console_clients import chromium

expect.set_options(timeout=30_000)  # for busy machines


@pytest.fixture(scope="module")
def console(analytic_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a console with one camera in the analytic scene."""
    with running_console(tmp_path_factory.mktemp("console"), analytic_folder, [analytic_folder.name]) as url:
        yield url


@contextmanager
def running_console(folder: Path, scene: Path, cameras: list[str], settings: Mapping[str, str] | None = None) -> Iterator[str]:
    """Run a console as a program and return its address. ``settings`` are further environment variables."""
    environment = {**os.environ, "SCOPE_SCENES_DIR": str(scene.parent), **(settings or {})}
    command = [sys.executable, "-m", "scope_ptz.cli", "console", "--port", "0", "--json"]
    command += [part for name in cameras for part in ("--camera", name)]
    with (folder / "errors").open("w") as errors:
        program = subprocess.Popen(
            [*command, "--runs-dir", str(folder / "runs")], env=environment, stdout=subprocess.PIPE, stderr=errors, text=True
        )
        try:
            assert program.stdout is not None
            line = program.stdout.readline()
            assert line, (folder / "errors").read_text()
            yield json.loads(line)["url"]
        finally:
            program.terminate()
            program.wait(30)
            assert program.stdout is not None
            program.stdout.close()
    assert "Traceback" not in (folder / "errors").read_text()


def wait_until_free(console: str) -> None:
    """Wait until nobody controls a camera, so that the next test can. Control ends with the run in progress, if there is one."""
    deadline_s = time.monotonic() + 60
    with httpx2.Client(base_url=f"{console}/api/v1", trust_env=False, timeout=60) as client:
        for name in client.get("/server").json()["cameras"]:
            while (now := client.get(f"/cameras/{name}/control").json())["holder"] is not None:
                assert time.monotonic() < deadline_s, f"{name} is still controlled: {now}"
                time.sleep(0.05)


def eventually(page: Page, holds: Callable[[], bool]) -> None:
    """Wait up to 20 s for a condition that is not visible on the page."""
    for _ in range(200):
        if holds():
            return
        page.wait_for_timeout(100)
    raise AssertionError("The condition did not come true within 20 s.")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Chromium. It must not outlive the tests of this package: its event loop in this thread would make asyncio.run() fail."""
    if not Path(chromium.PROGRAM).exists():
        pytest.fail(
            f"These tests need Chromium at {chromium.PROGRAM}: install it with 'apt-get install chromium', as .ci/run does."
        )
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=chromium.PROGRAM, args=list(chromium.ARGUMENTS))
        yield opened
        opened.close()


@dataclass
class PageWithErrors:
    """A browser context, with the errors of its pages."""

    context: BrowserContext
    url: str
    problems: list[str] = field(default_factory=list)
    foreign: list[str] = field(default_factory=list)

    def open(self) -> Page:
        """Open the console in a new tab and wait for its live view."""
        page = self.context.new_page()
        page.on("console", self._console)
        page.on("pageerror", lambda error: self.problems.append(str(error)))
        page.on(
            "request",
            lambda request: None if request.url.startswith((self.url, "blob:", "data:")) else self.foreign.append(request.url),
        )
        page.goto(self.url)
        page.wait_for_selector(".stage[data-fps]", timeout=120_000)
        return page

    def _console(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self.problems.append(message.text)


@pytest.fixture
def watched(console: str, browser: Browser) -> Iterator[PageWithErrors]:
    """A new browser profile. The test fails on errors in the browser console and on requests to other hosts."""
    with watching(console, browser) as found:
        yield found


@contextmanager
def watching(console: str, browser: Browser) -> Iterator[PageWithErrors]:
    """Return a context with a new browser profile. Errors in the browser console and requests to other hosts are failures."""
    context = browser.new_context(viewport={"width": 1280, "height": 720})
    context.set_default_timeout(60_000)
    found = PageWithErrors(context, console)
    yield found
    for page in context.pages:
        page.goto("about:blank")  # leaving the page gives up control
    wait_until_free(console)
    context.close()
    assert not found.problems
    assert not [url for url in found.foreign if not url.startswith(console.replace("http", "ws", 1))]

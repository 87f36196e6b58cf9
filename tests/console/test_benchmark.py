"""The Benchmark tab and the dialog of task drafts in Chromium, with real evaluations of a few tasks."""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx2
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, expect

from tests.console.conftest import PageWithErrors

pytestmark = pytest.mark.full
SLOW_MS = 240_000
"""Maximum time in milliseconds of an evaluation of a few tasks on a busy machine."""


@pytest.fixture
def page(watched: PageWithErrors) -> Iterator[Page]:
    expect.set_options(timeout=30_000)
    opened = watched.open()
    show(opened)
    yield opened
    with httpx2.Client(base_url=f"{watched.url}/api/v1", trust_env=False) as client:
        for each in client.get("/benchmark/evaluations").json():
            client.post(f"/benchmark/evaluations/{each['id']}/cancel")


def show(page: Page) -> None:
    page.get_by_role("button", name="Benchmark", exact=True).click()
    expect(page.get_by_label("Tasks", exact=True)).to_contain_text("lite")


def start(page: Page, limit: int, *categories: str) -> None:
    page.get_by_label("Tasks", exact=True).select_option("lite")
    page.get_by_label("Limit", exact=True).fill(str(limit))
    for name in categories:
        page.get_by_role("button", name=name, exact=True).click()
    expect(page.locator(".start .sum")).to_contain_text(f"{limit} task")
    page.get_by_role("button", name="Start", exact=True).click()
    expect(page.locator(".state")).to_have_text("Running")


def test_an_evaluation_is_started_watched_and_reported(page: Page, watched: PageWithErrors) -> None:
    start(page, 4, "counting", "single call")
    expect(page.get_by_role("button", name="Start", exact=True)).to_be_disabled()
    expect(page.locator(".start")).to_contain_text("An evaluation is in progress")
    expect(page.locator(".counts")).to_contain_text("of 4 tasks", timeout=SLOW_MS)
    page.reload()  # it belongs to the server
    show(page)
    expect(page.locator(".state")).to_have_text("Finished", timeout=SLOW_MS)
    expect(page.locator(".counts")).to_contain_text("4 of 4 tasks")
    expect(page.locator(".scores")).to_contain_text("95%")
    expect(page.get_by_role("progressbar")).to_have_attribute("aria-valuenow", "4")
    assert set(page.locator(".categories th").all_inner_texts()) == {"counting", "single call"}

    cards = page.locator(".failures button")
    expect(cards.first).to_contain_text("Expected")
    expect(cards.first).to_contain_text("Answered")
    failed = cards.count()
    page.get_by_label("Error mode").select_option(index=1)
    expect(page.get_by_role("heading", name=re.compile(r"Failures: \d+"))).to_be_visible()
    page.get_by_label("Error mode").select_option(index=0)
    expect(cards).to_have_count(failed)
    cards.first.focus()
    page.keyboard.press("Enter")
    dialog = page.locator("dialog.failure")
    expect(dialog.locator(".answers")).to_contain_text("Verdict")
    picture = dialog.locator(".large img")
    expect(picture).to_be_visible()
    page.wait_for_function("() => document.querySelector('.large img').naturalWidth > 100")
    assert "marks=true" in (picture.get_attribute("src") or "")
    dialog.get_by_label("Marks").uncheck()
    expect(picture).not_to_have_attribute("src", re.compile("marks"))
    expect(dialog.get_by_role("button", name=re.compile("^Show: ")).first).to_have_attribute(
        "aria-pressed", re.compile("true|false")
    )
    page.keyboard.press("Escape")
    expect(dialog).to_have_count(0)

    page.get_by_role("button", name="Make report").click()
    link = page.get_by_role("link", name="Open report")
    expect(link).to_be_visible(timeout=SLOW_MS)
    with page.expect_popup() as opened:
        link.click()
    report = opened.value
    expect(report.get_by_role("heading", name="SCOPE benchmark report")).to_be_visible()
    report.goto(report.evaluate("() => document.querySelector(\"a[href^='tasks/']\").href"))  # the link is in a closed list
    expect(report.locator("figure img").first).to_be_visible()
    report.wait_for_function("() => document.querySelector('figure img').naturalWidth > 100")
    report.close()

    page.get_by_role("button", name="Remove", exact=True).click()
    page.locator("dialog").get_by_role("button", name="Remove", exact=True).click()
    expect(page.locator(".intro")).to_be_visible()


def test_an_evaluation_is_cancelled_and_resumed(page: Page) -> None:
    start(page, 24)  # so many that some are left when it is cancelled
    expect(page.locator(".counts")).to_contain_text(re.compile(r"\b[1-9]\d? of 24 tasks"), timeout=SLOW_MS)
    page.get_by_role("button", name="Cancel", exact=True).click()
    expect(page.locator(".state")).to_have_text("Cancelled", timeout=SLOW_MS)
    page.get_by_role("button", name="Resume").click()
    expect(page.locator(".state")).to_have_text("Finished", timeout=SLOW_MS)
    expect(page.locator(".lead", has_text="resumed once")).to_be_visible()


def test_good_runs_become_drafts(page: Page) -> None:
    page.get_by_role("button", name="Live", exact=True).click()
    page.get_by_label("Instruction", exact=True).fill("pan left by 12 degrees")
    page.keyboard.press("Enter")
    page.locator(".turn").last.get_by_role("button", name="Good: this answer").click()
    page.get_by_role("button", name="Runs", exact=True).click()
    page.get_by_role("button", name="task drafts").click()
    dialog = page.locator("dialog.drafts")
    expect(dialog.locator(".draft-list li").first).to_contain_text("pan left by 12 degrees")
    with page.expect_download() as download:
        dialog.get_by_role("link", name="Download").click()
    assert download.value.suggested_filename == "drafts.jsonl"
    assert '"run"' in download.value.path().read_text()
    found = Axe().run(page, context="#scope")
    assert found.violations_count == 0, found.generate_report()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessibility(page: Page, scheme: str) -> None:
    page.evaluate("name => { document.documentElement.dataset.scopeTheme = name; }", scheme)
    cards = page.locator(".failures button")
    if not cards.count():
        start(page, 4, "counting", "single call")
        expect(page.locator(".state")).to_have_text("Finished", timeout=SLOW_MS)
    expect(cards.first).to_be_visible()
    found = Axe().run(page, context="#scope")
    assert found.violations_count == 0, found.generate_report()
    cards.first.click()
    expect(page.locator(".answers")).to_be_visible()
    found = Axe().run(page, context="#scope")
    assert found.violations_count == 0, found.generate_report()


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1280, 720), (390, 844)])
def test_nothing_is_cut_off(page: Page, width: int, height: int) -> None:
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_timeout(500)
    assert page.evaluate("document.querySelector('#scope').scrollWidth") <= width
    box = page.get_by_role("button", name="Start", exact=True).bounding_box()
    assert box is not None and box["x"] >= 0 and box["x"] + box["width"] <= width

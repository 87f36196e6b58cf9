"""The leaderboard in a browser: its script sorts the tables, and its security policy does not block the script."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, sync_playwright

from console_clients import chromium
from scope_ptz.bench.leaderboard.page import write_leaderboard
from tests.bench.leaderboard.test_leaderboard import entry

pytestmark = pytest.mark.full


def names(table: Locator) -> list[str]:
    found: list[str] = table.locator("tbody th").evaluate_all("rows => rows.map(row => row.dataset.order)")
    return found


def test_tables_can_be_sorted(tmp_path: Path) -> None:
    page_file = tmp_path / "page.html"
    write_leaderboard([entry("b", skill=9.0), entry("c", skill=0.3), entry("a", skill=-9.0), entry("grammar")], [], page_file)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium.PROGRAM, args=list(chromium.ARGUMENTS))
        page, problems = browser.new_page(), list[str]()
        page.on("console", lambda message: problems.append(message.text))
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.goto(page_file.as_uri())
        table = page.locator("table.sortable")
        assert names(table)[0] == "b"
        table.locator("thead button", has_text="Team").click()
        assert names(table) == ["a", "b", "c", "grammar"]
        table.locator("thead button", has_text="Team").click()
        assert names(table) == ["grammar", "c", "b", "a"]
        assert table.locator("th[aria-sort=descending]").inner_text().startswith("Team")
        table.locator("thead button", has_text="Rank").click()
        assert names(table) == ["b", "c", "a", "grammar"], "rows without a rank come last"
        browser.close()
    assert not problems

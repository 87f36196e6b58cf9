"""The operator console in Chromium."""

from __future__ import annotations

import re
from collections.abc import Callable

import httpx2
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, Route, expect

from tests.console.conftest import PageWithErrors

pytestmark = pytest.mark.full


def pose(page: Page) -> tuple[float, float, float]:
    """Return the pan and tilt in degrees and the zoom that the page shows."""
    texts = page.locator(".readout dd").all_inner_texts()
    pan, tilt, zoom = (float(re.sub("[°×]", "", text).replace("−", "-")) for text in texts)
    return pan, tilt, zoom


def wait_for_pose(page: Page, holds: Callable[[tuple[float, float, float]], bool]) -> tuple[float, float, float]:
    """Wait until the pose satisfies a condition, and return it."""
    for _ in range(200):
        if holds(now := pose(page)):
            return now
        page.wait_for_timeout(100)
    raise AssertionError(f"The camera is at {pose(page)}.")


@pytest.fixture
def page(watched: PageWithErrors) -> Page:
    opened = watched.open()
    with opened.expect_response(re.compile("/home$")) as home:  # the server replies when the camera has arrived
        opened.get_by_role("button", name="Home view (H)").click()
    pan, tilt, zoom = home.value.json()["pose"].values()
    wait_for_pose(opened, lambda now: now == (round(pan, 1), round(tilt, 1), round(zoom, 1)))
    return opened


def test_live_picture_keeps_updating(page: Page) -> None:
    before = int(page.locator(".stage").get_attribute("data-frame") or 0)
    page.wait_for_function("before => Number(document.querySelector('.stage').dataset.frame) > before + 20", arg=before)
    lit = "c => Array.from(c.getContext('2d').getImageData(0, 0, c.width, c.height).data).some((v, i) => i % 4 < 3 && v > 40)"
    assert page.locator("canvas.picture").evaluate(lit)


def test_click_centres_and_box_zooms(page: Page) -> None:
    pan, tilt, _ = pose(page)
    box = page.locator("canvas.picture").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 0.25 * box["height"])
    wait_for_pose(page, lambda now: now[0] > pan + 5 and now[1] > tilt + 2)
    page.mouse.move(box["x"] + 0.35 * box["width"], box["y"] + 0.35 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.65 * box["width"], box["y"] + 0.65 * box["height"], steps=4)
    page.mouse.up()
    wait_for_pose(page, lambda now: now[2] > 2.0)
    page.keyboard.press("u")
    wait_for_pose(page, lambda now: now[2] == 1.0)


def test_keys_wheel_and_map(page: Page) -> None:
    pan, _, _ = pose(page)
    page.keyboard.down("ArrowRight")
    wait_for_pose(page, lambda now: now[0] > pan + 3)
    page.keyboard.up("ArrowRight")
    page.locator("canvas.picture").hover()
    page.mouse.wheel(0, -200)
    wait_for_pose(page, lambda now: now[2] > 1.05)
    page.locator(".map canvas").click(position={"x": 60, "y": 50})
    wait_for_pose(page, lambda now: now[0] < -60)


def test_presets_are_saved_renamed_and_removed(page: Page) -> None:
    tiles = page.locator(".presets .tile")
    before = tiles.count()
    page.get_by_role("button", name="Save this view").click()
    page.get_by_label("Name of the preset").fill("test view")
    page.get_by_role("button", name="Save", exact=True).click()
    expect(tiles).to_have_count(before + 1)
    page.get_by_role("button", name="Rename test view").click()
    page.locator("dialog input").fill("other view")
    page.get_by_role("button", name="Rename", exact=True).click()
    expect(page.locator(".presets .name", has_text="other view")).to_be_visible()
    page.get_by_role("button", name="Remove other view").click()
    page.get_by_role("button", name="Remove", exact=True).click()
    expect(tiles).to_have_count(before)


def test_an_instruction_appears_in_the_library(page: Page) -> None:
    page.get_by_label("Instruction", exact=True).fill("pan right by 20 degrees")
    pan, _, _ = pose(page)
    page.keyboard.press("Enter")
    turn = page.locator(".turn").last
    expect(turn.locator(".step")).to_have_count(1)
    expect(turn.locator(".answer p").first).to_be_visible()
    wait_for_pose(page, lambda now: now[0] == pytest.approx(pan + 20, abs=0.2))
    turn.get_by_role("button", name="Good: this answer").click()
    expect(turn.get_by_role("button", name="Good: this answer")).to_have_attribute("aria-pressed", "true")

    page.reload()
    expect(page.locator(".turn .request")).to_have_text("pan right by 20 degrees")
    expect(page.locator(".turn .step")).to_have_count(1)

    page.locator(".turn").get_by_role("button", name="Frames").click()
    expect(page.get_by_role("heading", name="pan right by 20 degrees")).to_be_visible()
    expect(page.locator(".words")).to_contain_text("good")
    page.get_by_role("button", name="Replay").click()
    expect(page.locator("dialog.viewer img")).to_be_visible()
    page.keyboard.press("Escape")
    for pick in page.locator(".gallery input").all()[:2]:
        pick.check()
    page.get_by_role("button", name="Compare the two").click()
    expect(page.locator("dialog.viewer img")).to_have_count(2)
    page.keyboard.press("Escape")

    page.get_by_role("button", name="Timings").click()
    expect(page.locator(".bar-row").first).to_be_visible()
    expect(page.locator(".limit-label")).to_have_text("2 Hz")


def test_preview_moves_only_after_confirmation(page: Page) -> None:
    before = pose(page)
    page.get_by_label("Preview first").check()
    page.get_by_label("Instruction", exact=True).fill("pan left by 10 degrees")
    page.keyboard.press("Enter")
    expect(page.locator(".preview li").first).to_be_visible()
    assert pose(page) == before
    page.get_by_role("button", name="Carry it out").click()
    wait_for_pose(page, lambda now: now[0] == pytest.approx(before[0] - 10, abs=0.2))


def test_counted_objects_are_marked(page: Page) -> None:
    page.get_by_label("Instruction", exact=True).fill("how many people are there?")
    page.keyboard.press("Enter")
    result = page.locator(".turn .step .result").last
    expect(result).to_be_visible()
    count = re.match(r"(\d+)", result.inner_text())
    assert count is not None
    expect(page.locator(".overlay polygon")).to_have_count(int(count[1]))
    if int(count[1]):
        page.get_by_role("button", name="Hide marks").click()
        expect(page.locator(".overlay polygon")).to_have_count(0)


@pytest.mark.parametrize(
    "size", [(1920, 1080), (1440, 900), (1280, 720), (1100, 700), (1024, 768), (900, 700), (861, 600), (390, 844)]
)
def test_nothing_covers_the_stop_button(page: Page, size: tuple[int, int]) -> None:
    """The bar below the picture has its longest contents. They must not push the button out of the window or under the panel."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    covering = """button => {
        const texts = { ".readout dd": "−179.9°", ".rate": "25 frames/s", ".stage-time summary .clock": "1234:56 · 0.25×" };
        for (const [at, text] of Object.entries(texts)) document.querySelectorAll(at).forEach(each => { each.textContent = text; });
        document.querySelector(".stage .chip").hidden = false;
        button.scrollIntoView();
        const box = button.getBoundingClientRect();
        const points = [[0.5, 0.5], [0.05, 0.5], [0.95, 0.5], [0.5, 0.05], [0.5, 0.95]];
        const found = points.map(([x, y]) => document.elementFromPoint(box.left + x * box.width, box.top + y * box.height));
        return found.filter(each => !button.contains(each)).map(each => each?.outerHTML.slice(0, 80) ?? "outside the window");
    }"""
    assert page.get_by_role("button", name="Stop", exact=True).evaluate(covering) == []


def test_second_tab_joins_and_stops(page: Page, watched: PageWithErrors) -> None:
    other = watched.open()
    page.get_by_label("Instruction", exact=True).fill("keep panning right in 5 degree steps until you see a tram")
    page.keyboard.press("Enter")
    expect(other.locator(".turn .request")).to_be_visible()
    expect(other.locator(".turn .step").first).to_be_visible()
    other.get_by_role("button", name="Stop").click()
    for each in (page, other):
        expect(each.locator(".turn .outcome")).to_have_text("Cancelled")


def test_an_instruction_sent_during_a_run_is_kept(page: Page) -> None:
    text = page.get_by_label("Instruction", exact=True)
    text.fill("keep panning right in 5 degree steps until you see a tram")
    text.press("Enter")
    expect(page.locator(".turn .step").first).to_be_visible()
    text.fill("zoom in 2x")
    text.press("Enter")
    expect(page.locator(".notice")).to_contain_text("An instruction is in progress.")
    expect(text).to_have_value("zoom in 2x")
    page.get_by_role("button", name="Cancel the one in progress").click()
    expect(page.locator(".turn .outcome")).to_have_text("Cancelled")
    text.press("Enter")
    expect(page.locator(".turn .request").last).to_have_text("zoom in 2x")
    expect(page.locator(".turn .answer p").last).to_be_visible()


def test_an_instruction_sent_early_waits_for_the_camera(watched: PageWithErrors) -> None:
    def delay(route: Route) -> None:
        opened.wait_for_timeout(1000)
        route.continue_()

    with watched.context.new_page() as opened:
        opened.route("**/api/v1/cameras/*", delay)
        opened.goto(watched.url)
        text = opened.get_by_label("Instruction", exact=True)
        text.fill("zoom in 2x")
        text.press("Enter")
        expect(opened.locator(".turn .request")).to_have_text("zoom in 2x")
        expect(text).to_have_value("")


def test_control_is_handed_over(page: Page, watched: PageWithErrors) -> None:
    other = watched.open()
    other.get_by_role("button", name="Ask for control").click()
    page.get_by_role("button", name="Hand over").click()
    expect(other.locator(".control")).to_contain_text("You are in control")


def test_only_one_browser_moves_the_camera(page: Page, watched: PageWithErrors) -> None:
    """Only the browser in control moves the camera, until it hands control over."""
    other = watched.open()
    expect(other.locator(".control")).to_contain_text("is in control")
    before = pose(page)
    box = other.locator("canvas.picture").bounding_box()
    assert box is not None
    with other.expect_response(re.compile("/centre$")) as refused:
        other.mouse.click(box["x"] + 0.8 * box["width"], box["y"] + 0.5 * box["height"])
    assert refused.value.status == 409
    with other.expect_response(re.compile("/drive$")) as refused:
        other.keyboard.press("ArrowRight")
    assert refused.value.status == 409
    other.get_by_label("Instruction", exact=True).fill("go home")
    with other.expect_response(re.compile("/runs$")) as refused:
        other.keyboard.press("Enter")
    assert refused.value.status == 409
    expect(other.locator(".notices")).to_contain_text("Ask for control")
    assert pose(page) == pose(other) == before

    other.get_by_role("button", name="Ask for control").first.click()
    page.get_by_role("button", name="Keep").click()
    expect(other.locator(".control").get_by_role("button", name="Ask for control")).to_be_visible()
    other.locator(".control").get_by_role("button", name="Ask for control").click()
    page.get_by_role("button", name="Hand over").click()
    expect(other.locator(".control")).to_contain_text("You are in control")
    with page.expect_response(re.compile("/drive$")) as refused:
        page.keyboard.press("ArrowLeft")
    assert refused.value.status == 409
    with other.expect_response(re.compile("/drive$")) as allowed:
        other.keyboard.down("ArrowRight")
    assert allowed.value.status == 204
    wait_for_pose(other, lambda now: now[0] > before[0])
    other.keyboard.up("ArrowRight")
    # Chromium reports refused requests itself.
    watched.problems[:] = [problem for problem in watched.problems if "409 (Conflict)" not in problem]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessibility(page: Page, scheme: str) -> None:
    page.evaluate("name => { document.documentElement.dataset.scopeTheme = name; }", scheme)
    for view in ("Runs", "Timings", "Live"):
        page.get_by_role("button", name=view, exact=True).click()
        page.wait_for_timeout(500)
        found = Axe().run(page, context="#scope")
        assert found.violations_count == 0, found.generate_report()


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1280, 720), (390, 844)])
def test_nothing_is_cut_off(page: Page, width: int, height: int) -> None:
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_timeout(500)
    assert page.evaluate("document.querySelector('#scope').scrollWidth") <= width
    for name in ("Stop", "Send"):
        box = page.get_by_role("button", name=name).first.bounding_box()
        assert box is not None
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width


def test_replies_of_the_server(console: str) -> None:
    with httpx2.Client(base_url=console, trust_env=False) as client:
        reply = client.get("/")
        assert "connect-src 'self'" in reply.headers["content-security-policy"]
        assert "javascript" in client.get("/console/main.js").headers["content-type"]
        assert client.get("/", headers={"Host": "elsewhere.example"}).status_code == 403
        assert client.get("/api/v1/health").json() == {"status": "ok"}

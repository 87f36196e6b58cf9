"""The console's Cameras tab, scene time and errors of cameras, in Chromium."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Locator, Page, expect

from tests.console.conftest import PageWithErrors, eventually, running_console, watching

pytestmark = pytest.mark.full

BROKEN, OTHER = "yard-gate", "yard-two"


@pytest.fixture(scope="module")
def site(analytic_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a console with a scene, a configured camera in the same scene, and one that does not answer."""
    folder = tmp_path_factory.mktemp("cameras")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        closed = taken.getsockname()[1]
    (folder / "scope.yaml").write_text(
        f"""
cameras:
  {BROKEN}: {{camera: "axis://operator@127.0.0.1:{closed}", password: "env:GATE_PASSWORD"}}
  {OTHER}: {{camera: "sim:{analytic_folder.name}"}}
"""
    )
    settings = {"SCOPE_CONFIG": str(folder / "scope.yaml"), "GATE_PASSWORD": "not-to-be-seen"}
    with running_console(folder, analytic_folder, [analytic_folder.name, OTHER, BROKEN], settings) as url:
        yield url


@pytest.fixture
def watched(site: str, browser: Browser) -> Iterator[PageWithErrors]:
    with watching(site, browser) as found:
        yield found


@pytest.fixture
def page(watched: PageWithErrors) -> Page:
    return watched.open()


@pytest.fixture
def api(site: str) -> Iterator[httpx2.Client]:
    with httpx2.Client(base_url=f"{site}/api/v1", timeout=30.0, trust_env=False) as client:
        yield client


@pytest.fixture(scope="module")
def scene(analytic_folder: Path) -> str:
    return analytic_folder.name


def card(page: Page, name: str) -> Locator:
    """Return the card of a camera, once the tab shows it."""
    page.get_by_role("button", name="Cameras", exact=True).click()
    found = page.locator(f"article.card[data-name='{name}']")
    expect(found).to_be_visible()
    return found


def scene_time(api: httpx2.Client, name: str) -> dict[str, Any]:
    now: dict[str, Any] = api.get(f"/cameras/{name}/time").json()
    return now


def choose(page: Page, name: str) -> None:
    """Show a camera on the page and wait for its picture."""
    card(page, name).get_by_role("button", name=f"Show {name} on this page").click()
    expect(page.locator("select.camera")).to_have_value(name)
    expect(page.locator(".wait")).to_be_hidden()


def test_cards_show_the_kind_and_health_of_cameras(page: Page, scene: str) -> None:
    shown = card(page, scene)
    expect(shown).to_have_attribute("aria-current", "true")
    expect(shown.locator(".state")).to_have_text("Connected")
    expect(shown.locator(".abilities")).to_contain_text("virtual camera")
    page.wait_for_function("name => document.querySelector(`[data-name='${name}'] img`).naturalWidth > 100", arg=scene)
    broken = card(page, BROKEN)
    expect(broken.locator(".state")).to_have_text("Not available")
    expect(broken.locator(".why")).to_contain_text("cannot be reached")
    broken.get_by_role("button", name=f"Try {BROKEN} again").click()
    expect(broken.locator(".why")).to_contain_text("cannot be reached")
    expect(card(page, OTHER).locator(".control-row")).to_contain_text("Nobody is in control")
    assert "not-to-be-seen" not in page.content()


def test_a_page_follows_one_camera_and_conversations_stay_apart(page: Page, scene: str) -> None:
    page.get_by_label("Instruction", exact=True).fill("pan right by 10 degrees")
    page.keyboard.press("Enter")
    expect(page.locator(".turn .answer p").first).to_be_visible()
    choose(page, OTHER)
    expect(page.locator(".thread h2")).to_have_text("Tell the camera what to do")
    choose(page, scene)
    expect(page.locator(".turn .request")).to_have_text("pan right by 10 degrees")


def test_scene_time_on_the_stage_by_keyboard(page: Page, api: httpx2.Client, scene: str) -> None:
    line = page.locator(".stage-time summary")
    expect(line).to_be_visible()
    line.focus()
    page.keyboard.press("Enter")
    sheet = page.locator(".stage-time .sheet")
    sheet.get_by_role("button", name="Pause scene time").focus()
    page.keyboard.press("Enter")
    expect(line).to_contain_text("paused")
    stopped = scene_time(api, scene)
    assert stopped["playing"] is False
    page.wait_for_timeout(300)
    assert scene_time(api, scene) == stopped
    sheet.get_by_label("Scene time in seconds").focus()
    with page.expect_response(f"**/cameras/{scene}/time"):
        page.keyboard.press("Home")
    expect(line).to_have_text("0:00 · paused")
    sheet.get_by_role("button", name="Forward 10 seconds").click()
    expect(line).to_have_text("0:10 · paused")
    sheet.get_by_role("button", name="Back 10 seconds").click()
    expect(line).to_have_text("0:00 · paused")
    sheet.get_by_label("Speed of scene time").select_option("4")
    sheet.get_by_role("button", name="Play scene time").click()
    expect(line).to_contain_text("4×")
    eventually(page, lambda: scene_time(api, scene)["time_s"] > 1.5)
    sheet.get_by_label("Speed of scene time").select_option("1")
    page.keyboard.press("Escape")
    expect(sheet).to_be_hidden()
    expect(line).to_be_focused()


def test_the_slider_moves_the_scene_while_it_is_dragged(page: Page, api: httpx2.Client, scene: str) -> None:
    part = card(page, scene).locator(".scene-time")
    part.get_by_role("button", name="Pause scene time").click()
    slider = part.get_by_label("Scene time in seconds")
    box = slider.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 8, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2, steps=5)
    expect(part.locator(".clock")).not_to_have_text("0:00.0")
    page.mouse.up()
    wanted = float(slider.input_value())
    assert 40 < wanted < 80
    expect(part.locator(".clock")).to_have_text(f"{int(wanted // 60)}:{wanted % 60:04.1f}")
    eventually(page, lambda: scene_time(api, scene)["time_s"] == pytest.approx(wanted))
    part.get_by_role("button", name="Play scene time").click()
    expect(part.get_by_role("button", name="Pause scene time")).to_be_visible()


def test_only_the_client_in_control_changes_scene_time(page: Page, watched: PageWithErrors, api: httpx2.Client, scene: str) -> None:
    page.keyboard.press("h")
    expect(page.locator(".control")).to_contain_text("You are in control")
    other = watched.open()
    expect(other.locator(".control")).to_contain_text("This computer is in control, in another window or program.")
    watched.problems.clear()
    other.locator(".stage-time summary").click()
    other.get_by_role("button", name="Pause scene time").click()
    expect(other.locator(".notice")).to_contain_text("another window or program on this computer")
    assert scene_time(api, scene)["playing"] is True
    assert [each for each in watched.problems if "409" not in each] == []
    watched.problems.clear()  # Chromium reports every refused request
    expect(card(other, scene).locator(".control-row")).to_contain_text("This computer is in control")
    other.locator(".notice").get_by_role("button", name="Ask for control").click()
    expect(page.locator(".control")).to_contain_text("Another window or program on this computer asks for control.")
    page.get_by_role("button", name="Hand over").click()
    expect(other.locator(".control")).to_contain_text("You are in control")


def test_a_virtual_camera_is_turned_on_and_off(page: Page, scene: str) -> None:
    part = card(page, scene).locator(".virtual")
    switch = part.get_by_role("switch")
    expect(switch).to_have_attribute("aria-checked", "false")
    switch.focus()
    page.keyboard.press("Enter")
    expect(switch).to_have_attribute("aria-checked", "true")
    vapix, onvif, rtsp, account, password = part.locator("code").all_inner_texts()
    assert (
        vapix.startswith("http://127.0.0.1:") and onvif.endswith("/onvif/device_service") and rtsp.startswith("rtsp://127.0.0.1:")
    )
    picture = f"{vapix}/axis-cgi/jpg/image.cgi"
    with httpx2.Client(trust_env=False) as program:
        assert program.get(picture).status_code == 401
        assert program.get(picture, auth=httpx2.DigestAuth(account, password)).headers["content-type"] == "image/jpeg"
    page.reload()
    part = card(page, scene).locator(".virtual")
    expect(part.locator("code")).to_have_count(4)
    assert password not in page.content()
    part.get_by_role("switch").click()
    expect(part.get_by_role("switch")).to_have_attribute("aria-checked", "false")
    with pytest.raises(httpx2.ConnectError), httpx2.Client(trust_env=False) as program:
        program.get(picture)


def test_a_camera_failure_is_shown_once(page: Page, scene: str) -> None:
    card(page, BROKEN).get_by_role("button", name=f"Show {BROKEN} on this page").click()
    expect(page.locator(".wait")).to_contain_text("cannot be reached")
    page.wait_for_timeout(500)
    assert [each.is_visible() for each in page.get_by_text("cannot be reached").all()].count(True) == 1
    expect(page.locator(".notice")).to_have_count(0)
    expect(page.locator(".presets .tile")).to_have_count(0)  # those of the camera before
    expect(page.locator(".thread")).to_contain_text("when the camera responds")
    choose(page, scene)
    expect(page.locator(".presets .tile").first).to_be_visible()


def test_a_cancelled_instruction_is_reported_once(page: Page) -> None:
    page.get_by_label("Instruction", exact=True).fill("keep panning right in 5 degree steps until you see a tram")
    page.keyboard.press("Enter")
    expect(page.locator(".turn .step").first).to_be_visible()
    page.get_by_role("button", name="Stop").click()
    expect(page.locator(".turn .answer")).to_have_text("Cancelled")


def test_presets_are_on_the_map_before_a_visit(page: Page, api: httpx2.Client, scene: str) -> None:
    state = api.get(f"/cameras/{scene}").json()
    place = next(each for each in state["presets"] if each["viewpoint"] == state["viewpoint"])["pose"]
    drawn = """([pan, tilt]) => {
      const c = document.querySelector(".map canvas"), x = (pan + 180) / 360 * c.width, y = (60 - tilt) / 120 * c.height;
      const at = (x, y) => Array.from(c.getContext("2d").getImageData(x, y, 1, 1).data).join();
      return at(x, y) !== at(2, c.height / 2);
    }"""
    page.wait_for_function(drawn, arg=[place["pan_deg"], place["tilt_deg"]])


def test_keys_move_only_a_camera_that_can_be_seen(page: Page, api: httpx2.Client, scene: str) -> None:
    page.get_by_role("button", name="Cameras", exact=True).click()
    before = api.get(f"/cameras/{scene}/pose").json()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("h")
    page.wait_for_timeout(600)
    assert api.get(f"/cameras/{scene}/pose").json() == before


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessibility(page: Page, scene: str, scheme: str) -> None:
    page.evaluate("name => { document.documentElement.dataset.scopeTheme = name; }", scheme)
    page.locator(".stage-time summary").click()
    found = Axe().run(page, context="#scope")
    assert found.violations_count == 0, found.generate_report()
    part = card(page, scene).locator(".virtual")
    part.get_by_role("switch").click()
    expect(part.locator("code")).to_have_count(5)
    expect(card(page, BROKEN).locator(".why")).to_be_visible()
    found = Axe().run(page, context="#scope")
    part.get_by_role("switch").click()
    expect(part.locator("code")).to_have_count(0)
    assert found.violations_count == 0, found.generate_report()


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1280, 720), (390, 844)])
def test_nothing_is_cut_off(page: Page, scene: str, width: int, height: int) -> None:
    page.set_viewport_size({"width": width, "height": height})
    head = page.locator("#scope > .head").bounding_box()
    assert head is not None
    assert head["height"] <= 125, "the head has two lines on a phone, and one for control"
    for tab in page.locator("nav button").all():
        box = tab.bounding_box()
        assert box is not None
        assert box["x"] >= 0 and box["x"] + box["width"] <= width
    card(page, scene)
    tab = page.locator(".cameras")
    assert tab.evaluate("each => each.scrollWidth <= each.clientWidth")
    for each in tab.locator("article").all():
        assert each.evaluate("each => each.scrollWidth <= each.clientWidth")

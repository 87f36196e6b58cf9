"""Notebook representations of runs, frames, scenes and results."""

from __future__ import annotations

import base64
import io
import re

from PIL import Image

import scope_ptz
from scope_ptz.simulator.pack import Scene
from tests.agent.scripted import ScriptedPlanner, answer, calls
from tests.api.sessions import open_session


def pictures_in(html: str) -> list[Image.Image]:
    """Return the pictures that are embedded in HTML."""
    return [Image.open(io.BytesIO(base64.b64decode(data))) for data in re.findall(r"data:image/jpeg;base64,([^\"]+)", html)]


def test_a_run_shows_answer_filmstrip_and_calls(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope:
        html = scope.ask("count the things")._repr_html_()
    assert all(text in html for text in ("count the things", "There are 3.", "count_objects", "description=things"))
    (filmstrip,) = pictures_in(html)
    assert filmstrip.width <= 1100


def test_text_from_models_is_escaped(analytic_scene: Scene) -> None:
    evil = "<script>alert(1)</script>"
    planner = ScriptedPlanner(calls(("query_answer", {"question": evil}), (evil, {})), answer(evil))
    with open_session(analytic_scene, planner) as scope:
        html = scope.ask(evil)._repr_html_()
    assert "<script" not in html


def test_a_frame_shows_its_pose(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope:
        scope.move_to(pan_deg=12)
        frame = scope.frame()
    assert repr(frame).startswith("<Frame ") and len(repr(frame)) < 120, "the pixels must not be printed"
    html = frame._repr_html_()
    assert "pan +12.0°" in html
    (picture,) = pictures_in(html)
    assert picture.width / picture.height == frame.width / frame.height


def test_a_scene_shows_its_presets(analytic_scene: Scene) -> None:
    scene = scope_ptz.SceneInfo(analytic_scene)
    html = scene._repr_html_()
    assert scene.title in html
    assert f"scope_ptz.open(&quot;{scene.name}&quot;)" in html
    assert all(preset in html for preset in scene.presets)
    assert len(pictures_in(html)) == 1
    assert repr(scene).startswith(f"<SceneInfo {scene.name}")

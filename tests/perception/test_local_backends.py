"""Detectors and models in this process, with fakes for their weights. The full tier tests the real loading code."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.errors import ConfigError, PerceptionError
from scope_ptz.perception.backends import spec as specs
from scope_ptz.perception.backends import transformers_local as local
from scope_ptz.perception.backends import zero_shot
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Perception
from scope_ptz.perception.conformance import PerceptionConformance
from scope_ptz.perception.models.coordinates import get_convention
from scope_ptz.perception.models.frame_memo import Image
from tests.perception import pictures


def found(score: float, *box: float, label: str = "thing") -> dict[str, Any]:
    return {"score": score, "label": label, "box": dict(zip(("xmin", "ymin", "xmax", "ymax"), box, strict=True))}


def detector(image: Image, phrase: str) -> zero_shot.RawDetections:
    """A detector that finds the same object three times, once beyond the border and once with a low score."""
    if "unicorn" in phrase:
        return []
    return [
        found(0.6, 10, 12, 98, 100),
        found(0.9, 10, 10, 100, 100),
        found(0.5, 600, 300, 700, 400),
        found(0.05, 300, 10, 400, 90),
    ]


@pytest.mark.anyio
class TestZeroShot(PerceptionConformance):
    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield zero_shot.ZeroShotPerception(detector)

    def frame(self) -> Frame:
        return pictures.frame()


@pytest.mark.anyio
async def test_detections_are_suppressed_clipped_and_sorted() -> None:
    seen = await zero_shot.ZeroShotPerception(detector).detect(pictures.frame(), "thing")
    assert [b.score for b in seen.boxes] == [0.9, 0.5]
    assert (seen.boxes[1].x_max, seen.boxes[1].y_max) == (1.0, 1.0)
    assert "cut at the border" in seen.notes[0]


@pytest.mark.anyio
@pytest.mark.parametrize("error", [RuntimeError("CUDA out of memory"), ValueError("bad"), IndexError("argmax")])
async def test_a_failing_detector_is_an_error(error: Exception) -> None:
    def broken(image: Image, phrase: str) -> zero_shot.RawDetections:
        raise error

    with pytest.raises(PerceptionError, match="failed on a frame"):
        await zero_shot.ZeroShotPerception(broken).detect(pictures.frame(), "thing")
    with pytest.raises(PerceptionError, match="empty"):
        await zero_shot.ZeroShotPerception(detector).detect(pictures.frame(), " ")


class Moondream:
    """The methods of a loaded Moondream model."""

    def caption(self, image: Any, length: str) -> dict[str, str]:
        return {"caption": f"A {length} look at {image.size[0]} pixels."}

    def query(self, image: Any, question: str) -> dict[str, str]:
        return {"answer": "Yes."}

    def detect(self, image: Any, thing: str) -> dict[str, Any]:
        return {"objects": [] if "unicorn" in thing else [{"x_min": 0.1, "y_min": 0.1, "x_max": 0.2, "y_max": 0.2}]}

    def point(self, image: Any, thing: str) -> dict[str, Any]:
        return {"points": [] if "unicorn" in thing else [{"x": 0.15, "y": 0.15}]}


@pytest.mark.anyio
class TestMoondreamInProcess(PerceptionConformance):
    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield local.LocalMoondreamPerception(Moondream)

    def frame(self) -> Frame:
        return pictures.frame()


def chat(image: Image, prompt: str) -> tuple[str, bool]:
    """A Qwen2.5-VL model, which answers in pixels of the resized picture."""
    height, width = image.shape[:2]
    if "unicorn" in prompt:
        return "[]", False
    if prompt.startswith("Locate"):
        return f'[{{"bbox_2d": [{width // 4}, {height // 4}, {width // 2}, {height // 2}], "label": "thing"}}]', False
    if prompt.startswith("Point"):
        return f'[{{"point_2d": [{width // 2}, {height // 2}]}}]', False
    return "<think>well</think>Yes.", False


@pytest.mark.anyio
class TestChatInProcess(PerceptionConformance):
    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield local.LocalChatPerception(chat, get_convention("qwen2.5-vl"))

    def frame(self) -> Frame:
        return pictures.frame()


@pytest.mark.anyio
async def test_locations_are_scaled_from_the_size_that_the_model_received() -> None:
    perception = local.LocalChatPerception(chat, get_convention("qwen2.5-vl"), local.LocalOptions(max_pixels=100_000))
    (box,) = (await perception.detect(pictures.frame(width=1280, height=720), "thing")).boxes
    assert (box.x_min, box.y_min, box.x_max, box.y_max) == pytest.approx((0.25, 0.25, 0.5, 0.5), abs=0.01)


@pytest.mark.anyio
async def test_any_exception_of_a_model_is_a_perception_error() -> None:
    def load() -> Any:
        raise OSError("no such repository")

    for perception in (
        local.LocalMoondreamPerception(load),
        local.LocalChatPerception(lambda image, prompt: 1 / 0, get_convention("unit")),  # type: ignore[arg-type]
    ):
        for ask in (
            perception.caption(pictures.frame()),
            perception.query(pictures.frame(), "what?"),
            perception.detect(pictures.frame(), "thing"),
        ):
            with pytest.raises(PerceptionError, match="failed"):
                await ask


def make(**options: Any) -> Perception:
    return local.make(BackendSpec(name="eyes", backend="transformers_local", model="someone/model", options=options))


def test_remote_code_runs_only_at_a_pinned_commit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local, "require_packages", lambda *_: None)
    assert isinstance(make(), local.LocalChatPerception)
    with pytest.raises(ConfigError, match="trust_remote_code"):
        make(family="moondream")
    with pytest.raises(ConfigError, match="40 hex digits"):
        make(family="moondream", trust_remote_code=True, revision="main")
    assert isinstance(make(family="moondream", trust_remote_code=True, revision="0" * 40), local.LocalMoondreamPerception)


def test_missing_packages_are_reported_first() -> None:
    with pytest.raises(ConfigError, match=r"scope-ptz\[local\]"):
        specs.require_packages("local", "no_such_package_anywhere")

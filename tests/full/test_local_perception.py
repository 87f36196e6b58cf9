"""Perception with tiny checkpoints through the loading and serving code of transformers, in process and over HTTP."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from pathlib import Path

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Perception
from scope_ptz.perception.conformance import PerceptionConformance
from scope_ptz.perception.models.coordinates import smart_resize
from tests.full import vision
from tests.full.serving import transformers_serve

pytestmark = [
    pytest.mark.full,
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
]


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return vision.train_detector(tmp_path_factory.mktemp("vision"))


@pytest.fixture(scope="module")
def server(checkpoint: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with transformers_serve(checkpoint, tmp_path_factory.mktemp("serving") / "log.txt") as url:
        yield url


@pytest.fixture(params=["transformers_local", "openai_vision"])
def spec(request: pytest.FixtureRequest, checkpoint: Path) -> BackendSpec:
    """Return the spec of the same model, in this process or behind a server."""
    local_spec = BackendSpec(name="tiny", backend=request.param, model=str(checkpoint), coordinates=vision.STYLE.name)
    if request.param == "transformers_local":
        return local_spec
    return local_spec.model_copy(update={"endpoint": Endpoint(url=request.getfixturevalue("server"))})


@asynccontextmanager
async def open_backend(spec: BackendSpec) -> AsyncIterator[Perception]:
    perception = make_backend(spec)
    try:
        yield perception
    finally:
        await perception.close()


@pytest.mark.anyio
@pytest.mark.parametrize("corner", ["top left", "bottom right"])
async def test_a_vision_model_locates_an_object(spec: BackendSpec, corner: str) -> None:
    frame = vision.frame(corner)
    async with open_backend(spec) as perception:
        (box,) = (await perception.detect(frame, "square")).boxes
        expected = tuple(v / 1000 for v in vision.CORNERS[corner] or ())
        assert (box.x_min, box.y_min, box.x_max, box.y_max) == pytest.approx(expected)
        (point,) = (await perception.point(frame, "square")).points
        assert (point.x, point.y) == pytest.approx(box.centre)
        assert (await perception.query(frame, vision.QUESTION)).text == f"Yes, {corner}."
        assert (await perception.caption(frame)).text == f"A square: {corner}."


@pytest.mark.anyio
async def test_a_vision_model_reports_an_absence(spec: BackendSpec) -> None:
    async with open_backend(spec) as perception:
        assert (await perception.detect(vision.frame("nowhere"), "square")).boxes == ()
        assert (await perception.query(vision.frame("nowhere"), vision.QUESTION)).text == "No."


@pytest.mark.anyio
class TestConformance(PerceptionConformance):
    present, absent = "square", "square"

    @pytest.fixture(autouse=True)
    def _configure(self, spec: BackendSpec) -> None:
        self.spec, self.question = spec, vision.QUESTION

    def perception(self) -> AbstractAsyncContextManager[Perception]:
        return open_backend(self.spec)

    def frame(self) -> Frame:
        return vision.frame("bottom right")

    async def test_absent_objects_give_empty_results(self) -> None:
        """The tiny model knows only one object, so the picture does not contain it."""
        async with open_backend(self.spec) as perception:
            assert (await perception.detect(vision.frame("nowhere"), self.absent)).boxes == ()


def detector(maker: str, folder: Path, threshold: float) -> Perception:
    from tests.full import tiny_vision_models

    model = str(getattr(tiny_vision_models, maker)(folder))
    return make_backend(BackendSpec(name=maker, backend="zero_shot", model=model, options={"threshold": threshold}))


@pytest.mark.anyio
@pytest.mark.parametrize("maker", ["tiny_owlv2", "tiny_grounding_dino"])
async def test_detections_are_in_the_frame_and_best_first(maker: str, tmp_path: Path) -> None:
    perception, frame = detector(maker, tmp_path, threshold=0.0), vision.frame("top left")
    found = await perception.detect(frame, "orange cone")
    assert found.boxes and found.latency_s > 0 and found.source == maker
    scores = [b.score or 0.0 for b in found.boxes]
    assert scores == sorted(scores, reverse=True)
    assert all(0 <= b.x_min < b.x_max <= 1 and 0 <= b.y_min < b.y_max <= 1 for b in found.boxes)
    assert len((await perception.point(frame, "orange cone")).points) == len(found.boxes)


@pytest.mark.anyio
@pytest.mark.parametrize("maker", ["tiny_owlv2", "tiny_grounding_dino"])
async def test_scores_below_the_threshold_give_no_detections(maker: str, tmp_path: Path) -> None:
    assert (await detector(maker, tmp_path, threshold=1.0).detect(vision.frame("top left"), "cone")).boxes == ()


@pytest.mark.anyio
@pytest.mark.parametrize("backend", ["zero_shot", "transformers_local"])
async def test_a_missing_model_is_an_error(backend: str, tmp_path: Path) -> None:
    perception = make_backend(BackendSpec(name="vision", backend=backend, model=str(tmp_path / "nowhere")))
    with pytest.raises(PerceptionError):
        await perception.detect(vision.frame("top left"), "square")


@given(st.integers(14, 6000), st.integers(14, 6000), st.sampled_from([28, 32]), st.sampled_from([3136, 65536]))
def test_pictures_are_resized_as_in_transformers(width: int, height: int, factor: int, min_pixels: int) -> None:
    from transformers.models.qwen2_vl.image_processing_pil_qwen2_vl import smart_resize as reference_resize

    assume(max(width, height) / min(width, height) <= 200 and min(width, height) * 2 > factor)
    ours = smart_resize(width, height, factor=factor, min_pixels=min_pixels, max_pixels=1_310_720)
    assert ours[::-1] == reference_resize(height, width, factor=factor, min_pixels=min_pixels, max_pixels=1_310_720)
    if max(ours) / min(ours) <= 200:
        assert reference_resize(ours[1], ours[0], factor=factor, min_pixels=min_pixels, max_pixels=12_845_056) == ours[::-1]

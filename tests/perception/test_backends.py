"""The two simulated backends: the conformance suite, and their own behaviour."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any, cast

import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.errors import NotUnderstoodError, PackError, PerceptionError
from scope_ptz.geometry import Equirectangular
from scope_ptz.perception.base import Perception
from scope_ptz.perception.conformance import PerceptionConformance
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.noisy import Noise, NoisyPerception
from tests.perception import yard


def ground_truth() -> GroundTruthPerception:
    return GroundTruthPerception(
        cast(Any, lambda _: yard.StandInScene()), read_truth=lambda _s, _v, projection, _t: yard.truth(projection)
    )


@pytest.mark.anyio
class TestGroundTruth(PerceptionConformance):
    present = "traffic cone"
    absent = "dog"

    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield ground_truth()

    def frame(self) -> Frame:
        return yard.frame()

    def unreadable_frame(self) -> Frame:
        return yard.frame(real=True)


@pytest.mark.anyio
class TestNoisy(TestGroundTruth):
    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield NoisyPerception(ground_truth(), seed=3)


@pytest.mark.anyio
async def test_conformance_reports_each_failure() -> None:
    class Broken(TestGroundTruth):
        present = "unicorn"

    assert "unicorn" in (await Broken().findings())["test_detect_returns_boxes_inside_the_frame"]


@pytest.mark.anyio
async def test_real_frames_are_refused_with_a_reason() -> None:
    with pytest.raises(PerceptionError, match="real camera"):
        await ground_truth().query(yard.frame(real=True), "how many cars are there?")


@pytest.mark.anyio
async def test_damaged_scene_packs_are_errors() -> None:
    def broken(*_: object) -> Any:
        raise PackError("ids.png is damaged")

    with pytest.raises(PerceptionError, match="damaged"):
        await GroundTruthPerception(cast(Any, lambda _: yard.StandInScene()), read_truth=broken).detect(yard.frame(), "car")


@pytest.mark.anyio
@pytest.mark.parametrize("text", ["what is that", "from the docks preset"])
async def test_ground_truth_reports_a_description_that_is_not_a_noun_phrase(text: str) -> None:
    """It is an error of the caller, and not a count of 0."""
    with pytest.raises(NotUnderstoodError, match=re.escape(text)):
        await ground_truth().detect(yard.frame(), text)


@pytest.mark.anyio
@pytest.mark.parametrize("text", ["a dog", "red dogs", "purple vans"])
async def test_known_things_that_are_not_in_view_are_not_an_error(text: str) -> None:
    assert (await ground_truth().detect(yard.frame(), text)).boxes == ()


@pytest.mark.anyio
async def test_ground_truth_reports_a_question_that_it_does_not_understand() -> None:
    question = "why did the van go where it went"
    with pytest.raises(NotUnderstoodError, match=question):
        await ground_truth().query(yard.frame(), question)


@pytest.mark.anyio
@pytest.mark.parametrize("text", ["", "   "])
async def test_empty_input_is_an_error(text: str) -> None:
    with pytest.raises(PerceptionError):
        await ground_truth().detect(yard.frame(), text)
    with pytest.raises(PerceptionError):
        await ground_truth().query(yard.frame(), text)


@pytest.mark.anyio
async def test_largest_first_with_labels_and_without_scores() -> None:
    boxes = (await ground_truth().detect(yard.frame(), "vehicles")).boxes
    areas = [b.width * b.height for b in boxes]
    assert areas == sorted(areas, reverse=True)
    assert boxes[0].label == "delivery van"
    assert {b.score for b in boxes} == {None}


@pytest.mark.anyio
async def test_points_are_the_points_of_the_truth() -> None:
    found = await ground_truth().point(yard.frame(), "excavator")
    (sighting,) = (s for s in yard.truth().sightings if s.instance.id == "excavator-01")
    assert [(p.x, p.y) for p in found.points] == [sighting.point]


@pytest.mark.anyio
async def test_panoramas_are_read_at_their_own_projection() -> None:
    panorama = yard.frame(Equirectangular(-90.0, 180.0, 30.0, -60.0, 3600, 1800))
    assert len((await ground_truth().detect(panorama, "trees")).boxes) == 2


@pytest.mark.anyio
async def test_source_names_the_backend() -> None:
    assert (await ground_truth().caption(yard.frame())).source == "ground-truth"
    assert (await NoisyPerception(ground_truth(), seed=1).caption(yard.frame())).source == "noisy-ground-truth"


@pytest.mark.anyio
async def test_noise_depends_on_the_seed_and_nothing_else() -> None:
    async def boxes(seed: int, question: str = "cones") -> object:
        return (await NoisyPerception(ground_truth(), seed).detect(yard.frame(), question)).boxes

    assert await boxes(1) == await boxes(1)
    assert len({repr(await boxes(seed)) for seed in range(6)}) > 1


@pytest.mark.anyio
async def test_small_objects_are_missed_more_often() -> None:
    async def found(description: str) -> int:
        return sum([len((await NoisyPerception(ground_truth(), n).detect(yard.frame(), description)).boxes) for n in range(60)])

    cones, gantry = await found("cones") / 6, await found("gantry")
    assert cones < 0.85 * 60 < gantry


@pytest.mark.anyio
async def test_noise_duplicates_objects_and_misreads_texts() -> None:
    bad = Noise(miss=0.0, duplicate=1.0, misread=1.0)
    noisy = NoisyPerception(ground_truth(), seed=1, noise=bad)
    assert len((await noisy.detect(yard.frame(), "excavator")).boxes) == 2
    assert "Northgate" not in (await noisy.query(yard.frame(), "what does the van say?")).text


@pytest.mark.anyio
async def test_noise_of_zero_gives_the_truth() -> None:
    clean = NoisyPerception(ground_truth(), seed=1, noise=Noise(miss=0.0, duplicate=0.0, misread=0.0, jitter=0.0))
    for description in ("cars", "signs", "workers with helmets"):
        assert (await clean.detect(yard.frame(), description)).boxes == (
            await ground_truth().detect(yard.frame(), description)
        ).boxes

"""The model that recognises remarks, and the shorter versions of an instruction that it allows."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.planner.grammar.parsing.remark_detection.features import features_of
from scope_ptz.planner.grammar.parsing.remark_detection.model import LinearModel, remark_model
from scope_ptz.planner.grammar.parsing.remark_detection.segments import segments_of
from scope_ptz.planner.grammar.parsing.remark_detection.versions import versions_without_remarks
from scope_ptz.planner.plan import plan

PRESETS = ("yard", "main-gate")


def log_odds(text: str) -> list[float]:
    segments = segments_of(text)
    return [remark_model().log_odds(features_of(segments, index, PRESETS)) for index in range(len(segments))]


@given(st.text(max_size=80))
def test_segments_are_parts_of_the_text_in_order(text: str) -> None:
    segments = segments_of(text)
    assert all(text[segment.start : segment.end] == segment.text for segment in segments)
    assert all(before.end <= after.start for before, after in pairwise(segments))


@pytest.mark.parametrize(
    ("instruction", "command", "remark"),
    [
        ("Tilt up a lot, I want the top two floors in the picture.", 0, 1),
        ("Follow the lady with the brown dog, dogs are banned in here", 0, 1),
        ("The wind has dropped, count the cars", 1, 0),
        ("Zoom in 2x; the horizon is currently cut off.", 0, 1),
    ],
)
def test_remarks_have_higher_log_odds_than_requests(instruction: str, command: int, remark: int) -> None:
    found = log_odds(instruction)
    assert found[remark] > 0 > found[command]


def test_the_words_of_presets_are_no_features() -> None:
    segments = segments_of("go to the yard, please")
    assert not any("yard" in feature for feature in features_of(segments, 0, PRESETS))
    assert any("yard" in feature for feature in features_of(segments, 0, ()))


def test_log_odds_add_up() -> None:
    assert LinearModel(-1.0, {"a": 2.5, "b": -0.5}).log_odds({"a", "b", "unknown"}) == 1.0


@pytest.mark.parametrize(
    ("instruction", "calls"),
    [
        ("Tilt up a lot, I want the top two floors in the picture.", [("adjust_ptz", {"tilt_deg": 20.0})]),
        ("make it half as close, tops of the cars keep getting cut off", [("adjust_ptz", {"zoom_factor": 0.5})]),
        ("Go to the yard but don't take any pictures, half of them haven't signed the form", [("go_to_preset", {"name": "yard"})]),
    ],
)
def test_remarks_of_unknown_form_are_left_out(instruction: str, calls: list[tuple[str, dict[str, object]]]) -> None:
    made = plan(instruction, PRESETS)
    assert [(call.name, call.arguments) for call in made.calls] == calls


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("pan left, the other one please", "the other one"),
        ("zoom in, no wait, zoom out", "no wait"),
        ("take a picture, but only if it rains", "if it rains"),
        ("follow that woman and tell me when she is alone", "when she is alone"),
        ("count the cars, look over the full surroundings", "full surroundings"),
        ("left 20, the sun is low, right", "right"),
    ],
)
def test_what_may_change_the_request_is_kept(text: str, kept: str) -> None:
    assert all(kept in version for version in versions_without_remarks(text, PRESETS))


@pytest.mark.parametrize(
    "instruction",
    [
        "Gareth left the lamp on by the fizzbin, turn it round to him",  # "him" may be the subject of the remark
        "The guv wants it 20 to the left, flange it round to him somehow",
        "frobnicate the grommet and email it to Karen",
    ],
)
def test_what_is_not_accounted_for_is_asked_about(instruction: str) -> None:
    assert not plan(instruction, PRESETS).understood


def test_long_texts_and_many_segments_have_no_versions() -> None:
    assert list(versions_without_remarks("zoom in, " * 100, PRESETS)) == []
    assert list(versions_without_remarks("zoom in, " * 13, PRESETS)) == []


def test_a_sentence_keeps_its_end() -> None:
    versions = list(versions_without_remarks("Zoom in 2x, the horizon is cut off. Count the cars in the picture.", PRESETS))
    assert "Zoom in 2x. Count the cars in the picture." in versions

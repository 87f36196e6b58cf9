"""Lettering that the frame does not show legibly, or that is on another thing than people say."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.view import read_view
from scope_ptz.simulator.truth import ViewTruth
from tests.perception import yard

CHANGES: dict[str, dict[str, Any]] = {
    "lorry-01": {"attributes": {"colour": "orange", "lettering": "halden haulage"}},
    "gantry-01": {"name": "gantry"},
    "sign-02": {"name": "bracket", "category": "bracket"},
    # a statue on a plinth
    "cabin-01": {"name": "stone plinth", "category": "plinth"},
    "tree-02": {
        "name": "bronze statue",
        "category": "statue",
        "parent": "cabin-01",
        "box_min_m": (25.0, 57.0, 2.8),
        "box_max_m": (27.0, 59.0, 5.0),
    },
}


def lettered(cap_height_px: float = 20.0) -> tuple[ViewTruth, Any]:
    """Return the ground truth and the scene of the yard in which the gantry and a plinth have lettering of this height."""
    instances = {i.id: i.model_copy(update=CHANGES.get(i.id, {})) for i in yard.SCENE.instances}
    scene = yard.SCENE.model_copy(update={"instances": list(instances.values())})
    truth = yard.truth()
    sightings = tuple(replace(s, instance=instances.get(s.instance.id, s.instance)) for s in truth.sightings)
    boxes = {s.instance.id: s.box for s in sightings}
    north = next(t.text for t in truth.texts if t.text.parent == "sign-02")
    bearers = [("gantry-01", "A1 North", 0.0), ("gantry-01", "50", 9.0), ("cabin-01", "JOHN ALDER", 0.0)]
    texts = tuple(
        replace(
            truth.texts[0],
            text=north.model_copy(update={"id": f"{parent}-{text}", "text": text, "parent": parent, "centre_m": (x_m, 1.0, 0.0)}),
            box=boxes[parent],
            cap_height_px=cap_height_px,
        )
        for parent, text, x_m in bearers
    )
    return replace(truth, sightings=sightings, texts=texts), scene


def ask(question: str, cap_height_px: float = 20.0) -> tuple[str, bool]:
    truth, scene = lettered(cap_height_px)
    return tuple(answer(read_view(truth, scene, 5.0), parse_question(question)))  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("what is written on the lorry?", "I cannot tell what is written on the lorry."),
        ("is there any text on the lorry?", "I cannot tell whether there is text on the lorry."),
    ],
)
def test_text_that_the_scene_states_but_no_frame_shows_is_not_called_absent(question: str, expected: str) -> None:
    assert ask(question) == (expected, False)


def test_the_text_on_a_statue_is_on_its_plinth() -> None:
    assert ask("what does the sign on the statue say?") == ('The stone plinth reads "JOHN ALDER".', True)
    assert ask("what is written on the statue?", 6.0) == ("The text is on the stone plinth, but it is too small to read.", False)


def test_the_signs_on_a_gantry_are_its_groups_of_texts() -> None:
    assert ask("how many signs are on the gantry?") == ("At least 2 signs are on the gantry.", True)


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("are there any signs on the gantry?", ("Yes, there are at least 2 signs on the gantry.", True)),
        ("is there a sign on the gantry?", ("Yes, there are at least 2 signs on the gantry.", True)),
        ("are there no signs on the gantry?", ("No, there are at least 2 signs on the gantry.", True)),
        ("are there at least three signs on the gantry?", ("I cannot tell whether there are any signs on the gantry.", False)),
        ("are there any signs on the lorry?", ("No, there are no signs on the lorry in view.", True)),
    ],
)
def test_the_signs_on_a_gantry_are_not_denied(question: str, expected: tuple[str, bool]) -> None:
    assert ask(question) == expected


@pytest.mark.parametrize(
    "question",
    [
        "how many signs on the gantry say closed?",
        "how many signs on the gantry are red?",
        "how many signs on the gantry are broken?",
        "how many speed limit signs are on the gantry?",
        "is there a red sign on the gantry?",
    ],
)
def test_nothing_but_their_number_is_known_of_the_signs_on_a_gantry(question: str) -> None:
    text, is_known = ask(question)
    assert text.startswith("I cannot tell ")
    assert not is_known


@pytest.mark.anyio
async def test_a_search_finds_the_signs_on_a_gantry() -> None:
    truth, scene = lettered()
    stand_in = yard.StandInScene()
    stand_in.file = scene
    found = await GroundTruthPerception(lambda _: stand_in, lambda *_: truth).detect(yard.frame(), "signs on the gantry")  # type: ignore[arg-type, return-value]
    assert (len(found.boxes), found.complete) == (2, False)

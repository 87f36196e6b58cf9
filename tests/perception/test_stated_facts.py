"""Questions about prices and times, which only texts state, and about places and activities that the scene does not state."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.errors import NotUnderstoodError
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.perception.ground_truth.answers import answer
from scope_ptz.perception.ground_truth.view import View, read_view
from tests.perception import yard

NAMES = {
    "sign-01": "price card for lettuce",
    "sign-02": "menu board",
    "sign-03": "post sign",
    "fence-panel-01": "price card for apples",
    "arrow-board-01": "price card for red apples",
}
TEXTS = [
    ("sign-01", "LETTUCE"), ("sign-01", "0.95"), ("sign-02", "FISH PIE 8.90"), ("sign-02", "SOUP 4.50"), ("sign-03", "POST"),
    ("sign-03", "NEXT 9.30 AM"), ("fence-panel-01", "APPLES"), ("fence-panel-01", "1.20"), ("arrow-board-01", "APPLES"),
    ("arrow-board-01", "1.35"), ("gate-01", "GATE LOCKED"), ("gate-01", "22:00 TO 05:00"), ("cabin-01", "SUMMER FAIR"),
    ("cabin-01", "SATURDAY 14 JUNE"),
]  # fmt: skip


def market(legible: bool = True) -> View:
    """Return a view of the yard with other names and texts on its signs."""
    truth = yard.truth()
    instances = [i.model_copy(update={"name": NAMES.get(i.id, i.name)}) for i in yard.SCENE.instances]
    scene = yard.SCENE.model_copy(update={"instances": instances})
    by_id = {i.id: i for i in instances}
    sightings = tuple(replace(s, instance=by_id.get(s.instance.id, s.instance)) for s in truth.sightings)
    boxes = {s.instance.id: s.box for s in truth.sightings}
    texts = tuple(
        replace(
            truth.texts[0],
            text=truth.texts[0].text.model_copy(update={"id": f"text-{i}", "text": text, "parent": parent}),
            box=boxes[parent],
            cap_height_px=20.0 if legible else 3.0,
        )
        for i, (parent, text) in enumerate(TEXTS)
    )
    return read_view(replace(truth, sightings=sightings, texts=texts), scene, 5.0)


@pytest.mark.parametrize(
    ("question", "expected"),
    [
        ("how much is the lettuce?", "The price of the lettuce is 0.95."),
        ("what does the lettuce cost?", "The price of the lettuce is 0.95."),
        ("how much does a lettuce cost?", "The price of a lettuce is 0.95."),
        ("what is the price of the lettuce?", "The price of the lettuce is 0.95."),
        ("how much is the fish pie?", "The price of the fish pie is 8.90."),
        ("how much is the soup on the menu?", "The price of the soup is 4.50."),
        ("how much are the apples?", "There are 2 prices for the apples: 1.20 and 1.35."),
        ("how much is a horse?", "I cannot tell: nothing that I can read in view states the price of a horse."),
        ("when is the gate locked?", 'The site gate reads "GATE LOCKED" and "22:00 TO 05:00".'),
        ("when is the summer fair?", 'The site cabin reads "SUMMER FAIR" and "SATURDAY 14 JUNE".'),
        ("when is the next collection from the post sign?", 'The post sign reads "POST" and "NEXT 9.30 AM".'),
        ("when does the lorry leave?", "I cannot tell: nothing that I can read in view states a time for the lorry."),
    ],
)
def test_prices_and_times(question: str, expected: str) -> None:
    text, known = answer(market(), parse_question(question))
    assert text == expected
    assert known is not text.startswith("I cannot tell")


def test_a_price_that_is_too_small_to_read_names_its_card() -> None:
    assert answer(market(legible=False), parse_question("how much is the lettuce?")) == (
        "The price of the lettuce is on the price card for lettuce, but it is too small to read.", False
    )  # fmt: skip


@pytest.mark.anyio
async def test_an_empty_search_in_an_unknown_place_is_not_a_count_of_zero() -> None:
    truth = GroundTruthPerception(lambda _: yard.StandInScene(), lambda *_: yard.truth())  # type: ignore[arg-type, return-value]
    with pytest.raises(NotUnderstoodError, match="I cannot tell what is on the pavement"):
        await truth.detect(yard.frame(), "people on the pavement")
    assert (await truth.query(yard.frame(), "how many people are on the pavement?")).known is False
    assert (await truth.detect(yard.frame(), "cars in the left lane")).boxes
    assert (await truth.detect(yard.frame(), "dogs")).boxes == ()


@pytest.mark.anyio
async def test_qualities_that_no_scene_states_are_not_absent() -> None:
    truth = GroundTruthPerception(lambda _: yard.StandInScene(), lambda *_: yard.truth())  # type: ignore[arg-type, return-value]
    with pytest.raises(NotUnderstoodError, match="I cannot tell what is dangerous"):
        await truth.detect(yard.frame(), "dangerous cars")
    with pytest.raises(NotUnderstoodError, match="'florp'"):
        await truth.query(yard.frame(), "is there a florp?")
    for question in ("is there anything unusual?", "is there a fancy car?", "is everyone ok?", "is everything under control?"):
        reply = await truth.query(yard.frame(), question)
        assert not reply.known, question
        assert reply.text.startswith("I cannot tell")
    assert (await truth.query(yard.frame(), "is there a giraffe?")).known

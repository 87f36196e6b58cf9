"""Ground truth of the shipped scenes states only what a picture shows, and says what it cannot tell."""

from __future__ import annotations

import asyncio
from functools import cache

import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.errors import NotUnderstoodError
from scope_ptz.factory.cameras.opening import open_camera
from scope_ptz.perception.base import Answer, Detections
from scope_ptz.perception.ground_truth import GroundTruthPerception

pytestmark = pytest.mark.full  # reads the ground truth of whole scenes


@cache
def look(scene: str, preset: str) -> tuple[GroundTruthPerception, Frame]:
    """Return ground truth and the frame at a preset."""

    async def take() -> tuple[GroundTruthPerception, Frame]:
        async with await open_camera(f"sim:{scene}", preset=preset) as opened:
            assert opened.scenes is not None
            return GroundTruthPerception(opened.scenes), await opened.camera.frame()

    return asyncio.run(take())


def ask(scene: str, preset: str, question: str) -> Answer:
    truth, frame = look(scene, preset)
    return asyncio.run(truth.query(frame, question))


def detect(scene: str, preset: str, description: str) -> Detections:
    truth, frame = look(scene, preset)
    return asyncio.run(truth.detect(frame, description))


DOCKS, GATEHOUSE = ("freight-yard", "docks"), ("freight-yard", "gatehouse")
TAXIS, MARKET, SQUARE = ("station-square", "taxi-rank"), ("station-square", "market"), ("station-square", "square")
STREET, ZEBRA, STOP = ("high-street", "high-street"), ("high-street", "zebra"), ("high-street", "bus-stop")
COMPOUND = ("highway-works", "compound")


@pytest.mark.parametrize(
    ("place", "question", "expected"),
    [
        (DOCKS, "how many cars are there?", "There are no cars in view."),  # and not the worker who is carrying a box
        (DOCKS, "which dock is the blue truck at?", "The blue truck is at dock 2."),
        (GATEHOUSE, "is the barrier raised?", "Yes, 1 of the 2 barrier arms is raised: the one on the left."),
        (TAXIS, "is anyone waiting for a taxi?", "Yes, 1 of the 5 people is waiting for a taxi: the one on the left."),
        (STOP, "how many people are waiting at the bus stop?", "2 people are at the bus stop."),
        (STOP, "is anyone waiting at the bus stop?", "Yes, 2 of the 19 people are at the bus stop."),
        (MARKET, "what does the purple stall sell?", "The purple stall sells flowers."),
        (MARKET, "which stall is selling bread?", "A yellow and white market stall sells bread, on the left."),
        (MARKET, "how many customers are at the green stall?", "2 customers are at the green stall."),
        (SQUARE, "what time does the clock show?", "The station clock shows 9:41."),
        (SQUARE, "whats the time on the clock?", "The station clock shows 9:41."),
        (SQUARE, "what time is it?", "The station clock shows 9:41."),
        (STREET, "are the striped awnings red or blue?", "1 of the 3 striped awnings is red and 1 is blue."),
        (STREET, "is the white van to the left or to the right of the bus?", "The white van is to the right of the bus."),
        (COMPOUND, "which cabin is above the grey one?", "A blue site cabin is above the grey one, at the top right."),
        (COMPOUND, "what colour is the helmet of the worker on the left?", "The helmet is yellow."),
    ],
)
def test_what_a_picture_shows_is_stated(place: tuple[str, str], question: str, expected: str) -> None:
    reply = ask(*place, question)
    assert (reply.text, reply.known) == (expected, True)


@pytest.mark.parametrize(
    ("place", "question", "expected"),
    [
        (ZEBRA, "is anyone on the crossing?", "I cannot tell whether anyone is on the crossing."),
        (ZEBRA, "is the zebra crossing clear?", "I cannot tell whether the zebra crossing is clear."),
        (ZEBRA, "how many people are on the crossing?", "I cannot tell how many people are on the crossing."),
        (ZEBRA, "what is on the crossing?", "I cannot tell what is on the crossing."),
        (ZEBRA, "is anyone crossing the road?", "I cannot tell whether anyone is crossing."),
        (TAXIS, "is there a driver in the taxi?", "I cannot see who is in the taxi."),
        (TAXIS, "is anyone in the taxi?", "I cannot see who is in the taxi."),
        (TAXIS, "who is driving the silver taxi?", "I cannot see who is in the silver taxi."),
        (TAXIS, "is the taxi empty?", "I cannot tell whether the taxi is empty."),
        (TAXIS, "is the driver's door open?", "I cannot tell whether the driver's door is open."),
        (DOCKS, "is there a driver in the lorry?", "I cannot see who is in the lorry."),  # the driver stands beside it
        (TAXIS, "is anyone waiting for the bus?", "I cannot tell whether anyone is waiting."),
        (STREET, "how many windows does the town hall have?", "I cannot tell how many windows the town hall has."),
        (STREET, "is anyone wearing red?", "I cannot tell whether anyone is wearing red."),
        (STREET, "which shops have striped awnings?", "I cannot tell which shops have striped awnings."),
        (STREET, "are there more men than women?", "I cannot tell which of 12 people are men."),
        (STREET, "what time does the clock show?", "The town hall clock is too small to read."),
        (STREET, "what's the time?", "The town hall clock is too small to read."),
        (MARKET, "which stalls have striped awnings?", "I cannot tell which stalls have striped awnings."),
        (MARKET, "is there a woman?", "I cannot tell whether there is a woman."),
        (MARKET, "how many women are there?", "I cannot tell how many women there are."),
        (COMPOUND, "is the cabin door open?", "I cannot tell whether the cabin door is open."),
    ],
)
def test_what_a_picture_does_not_show_is_not_claimed(place: tuple[str, str], question: str, expected: str) -> None:
    reply = ask(*place, question)
    assert (reply.text, reply.known) == (expected, False)


@pytest.mark.parametrize(
    ("place", "question", "colours"),
    [(DOCKS, "what colour are the helmets?", {"red", "white", "yellow"}), (DOCKS, "what colour is his helmet?", {"red", "white"})],
)
def test_the_colour_of_clothes_is_a_colour(place: tuple[str, str], question: str, colours: set[str]) -> None:
    text = ask(*place, question).text
    assert "vest" not in text
    assert all(f"is {colour}" in text for colour in colours)


def test_a_count_of_people_of_unknown_sex_may_be_incomplete() -> None:
    women = detect(*STREET, "women")
    assert [box.label for box in women.boxes] == ["woman with a pram"]
    assert not women.complete
    with pytest.raises(NotUnderstoodError, match="I cannot tell which of 13 people are women"):
        detect(*MARKET, "women")
    assert not detect(*MARKET, "people").complete  # others are too far away or cut off


def test_people_wait_only_where_the_scene_says_so() -> None:
    waiting = detect(*STOP, "people waiting")
    assert [box.label for box in waiting.boxes] == ["pedestrian waiting"]
    assert not waiting.complete
    assert {box.label for box in detect(*STOP, "people waiting at the bus stop").boxes} == {
        "person sitting at the bus stop", "pedestrian on the phone"
    }  # fmt: skip


def test_red_clothes_are_not_a_red_umbrella() -> None:
    with pytest.raises(NotUnderstoodError, match="I cannot tell which of 12 people are wearing red"):
        detect(*STREET, "man in red")
    assert len(detect(*STREET, "person with a red umbrella").boxes) == 1


def test_a_description_begins_with_the_people_that_a_count_finds() -> None:
    place = ("station-square", "square")
    number = len(detect(*place, "people").boxes)
    text = ask(*place, "what can you see?").text
    assert text.startswith(f"I can see {number} people, ")
    assert ", among other things" in text


@pytest.mark.parametrize(
    ("place", "question", "expected"),
    [
        (("freight-yard", "car-park"), "is the car park full?", "No, only 10 of the 17 parking spaces are full."),
        (DOCKS, "is a person driving the taxi?", "There is no taxi in view."),
        (DOCKS, "who is driving the taxi?", "There is no taxi in view."),
    ],
)
def test_answers_judge_wholes_by_their_parts_and_name_what_is_absent(place: tuple[str, str], question: str, expected: str) -> None:
    assert ask(*place, question).text == expected


def test_the_signs_include_the_lettering_on_buildings() -> None:
    text = ask("freight-yard", "car-park", "what do the signs say?").text
    assert text.startswith('I can read 4 of the 20 signs in view: "1", "STAFF PARKING", "34" and "35". The other 16 are ')
    assert 'I can also read "ARKWRIGHT TIMBER" on the green industrial shed. A closer view may help with ' in text


@pytest.mark.parametrize("question", ["what do the signs say?", "what does the sign say?"])
def test_the_illegible_signs_that_face_the_camera_are_named(question: str) -> None:
    reply = ask(*GATEHOUSE, question)
    assert not reply.known
    assert reply.text.endswith(
        "too small to read. A closer view may help with the thank you sign, the drivers sign and the empty containers sign."
    )


def test_a_red_sign_comes_before_a_sign_with_a_red_rim() -> None:
    text = ask("highway-works", "works", "what does the red sign say?").text
    assert '"50"' not in text
    assert "works access sign" in text or "WORKS ACCESS" in text


def test_the_lettering_of_a_cabin_is_its_sign() -> None:
    text = ask(*COMPOUND, "what does the sign on the green cabin say?").text
    assert text == "There is text on the green cabin, but it is seen too much from the side to read."


def test_a_sign_that_is_not_the_only_one_is_not_read_as_one() -> None:
    text = ask(*DOCKS, "what does the sign on the left say?").text
    assert " signs on the left in view: " in text


def test_a_price_may_be_on_a_menu_that_is_too_small() -> None:
    reply = ask("station-square", "terrace", "how much is the omelette?")
    assert (reply.text, reply.known) == (
        "The price of the omelette may be on the chalk menu board, but it is too small to read.", False
    )  # fmt: skip


def test_a_text_is_located_although_it_is_no_thing_of_its_own() -> None:
    (plate,) = detect(*TAXIS, "number plate of the silver taxi").boxes
    (taxi,) = detect(*TAXIS, "silver taxi").boxes
    assert taxi.x_min <= plate.centre[0] <= taxi.x_max and taxi.y_min <= plate.centre[1] <= taxi.y_max
    assert detect(*STREET, "text on the red bus").boxes

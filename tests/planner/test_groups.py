"""What "the other one", "both", totals and shares refer to after several things were counted or listed."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Pose
from scope_ptz.planner.base import PastTurn
from scope_ptz.planner.grammar.binding.answered_things import single_thing, stated_number, two_members
from scope_ptz.planner.grammar.binding.focus import Focus
from scope_ptz.planner.grammar.binding.narrowing import are_exclusive, narrowed
from scope_ptz.planner.grammar.binding.pairs import other_of
from scope_ptz.planner.grammar.execution.close_ups import view_before_close_ups
from tests.planner.stage import Stage
from tests.planner.test_references import ASK, COUNT, ZOOM, last_turn


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("zoom in on the left one", "no, the other one"), (ZOOM, "right dog")),
        (("zoom in on the left one", "and the other one?"), (ZOOM, "right dog")),
        (("what is the right one doing?", "and the other one?"), (ASK, "what is the left dog doing?")),
        (("zoom in on the left one", "what colour is the other one?"), (ASK, "what colour is the right dog?")),
        (("zoom in on the nearest one", "the other one"), (ZOOM, "farthest dog")),
        (("zoom in on the first dog", "now the other dog"), (ZOOM, "second dog")),
    ],
)
def test_the_other_of_two_is_the_opposite(instructions: tuple[str, ...], expected: tuple[str, str]) -> None:
    assert last_turn("how many dogs are there?", *instructions, count=2)[0][-1] == expected


@pytest.mark.parametrize(
    ("taken", "other"),
    [
        ("left dog", "right dog"),
        ("dog on the left", "dog on the right"),
        ("worker with a white helmet", "worker without a white helmet"),
        ("man carrying a box", "man without a box"),
        ("dog in front of the van", ""),
        ("dog with a man", ""),
        ("dog next to the left van", ""),
        ("dog on top of the wall", ""),
    ],
)
def test_the_other_of_two_differs_in_what_belongs_to_the_thing(taken: str, other: str) -> None:
    assert other_of(Focus("dogs", 2, "count_objects"), taken) == other


def test_the_other_of_two_that_an_answer_listed() -> None:
    answer = "There are 2 skips: a blue skip on the left about 30 m away and a yellow skip on the left about 35 m away."
    assert last_turn("where are the skips?", "zoom in on the yellow one", "and the other one?", answer=answer)[0] == [
        (ZOOM, "blue skip on the left")
    ]
    choices = "Which of the 2 do you mean: the left dog or the right dog?"
    assert last_turn("how many dogs are there?", "and the other one?", count=2) == ([], choices)


@pytest.mark.parametrize("wording", ["zoom in on both", "show me both", "zoom in on both of them"])
def test_both_are_shown_one_after_the_other(wording: str) -> None:
    assert last_turn("how many dogs are there?", wording, count=2)[0] == [(ZOOM, "left dog"), (ZOOM, "right dog")]
    answer = "2 skips: 1 blue and 1 yellow."
    assert last_turn("what colours are the two skips?", wording, answer=answer)[0] == [(ZOOM, "blue skip"), (ZOOM, "yellow skip")]


def test_members_are_described_as_they_were_listed() -> None:
    assert two_members("There are 2 vans: one on the left and one on the right.", "vans") == ("van on the left", "van on the right")
    assert two_members("There are 3 vans: 2 white and 1 red.", "vans") == ()
    assert two_members("A pointing worker and a worker on the phone are wearing helmets.", "person wearing a helmet") == ()
    assert single_thing("Yes, there is a black dog at the bottom left.") == "black dog"
    assert [stated_number(x, "dogs") for x in ("There are no dogs in view.", "Yes, there is a black dog.")] == [0, 1]


class _Yard(Stage):
    """A simulated camera whose close-ups end at ``lands``, and that finds ``hidden`` only in the wide view."""

    hidden = ""

    def do(self, name, arguments):  # type: ignore[no-untyped-def]
        close = self.pose.zoom > 1.5
        self.looks = [2 if name == COUNT else {"answer": "Grey.", "known": True} if name == ASK else True]
        if name == ZOOM and close and arguments["description"] == self.hidden:
            self.calls.append((name, arguments))
            return {"found": False, "source": "ground-truth", "pose": self.pose.as_dict()}, None
        return super().do(name, arguments)


def _replies(*instructions: str, hidden: str = "", simulated: bool = True) -> tuple[list[str], str]:
    stage = _Yard(simulated=simulated, lands=Pose(10, 0, 4))
    stage.hidden = hidden
    turns: tuple[PastTurn, ...] = ()
    for instruction in instructions:
        stage.calls.clear()
        turns = (*turns, stage.turn(instruction, turns))
    return [name for name, _ in stage.calls], turns[-1].reply


def test_another_one_is_looked_for_in_the_view_before_the_close_up() -> None:
    calls, reply = _replies("how many vans are there?", "zoom in on the left one", "and the other one?")
    assert calls == ["adjust_ptz", ZOOM]
    assert reply.startswith("I went back to the view before. I zoomed in on the right van")
    assert _replies("how many vans are there?", "zoom in on the left one", "what colour is the other one?")[0] == [
        "adjust_ptz",
        ASK,
    ]


def test_what_is_not_in_the_close_up_is_looked_for_in_the_view_before() -> None:
    calls, reply = _replies("zoom in on the red van", "zoom in on the blue van", hidden="blue van")
    assert calls == [ZOOM, "adjust_ptz", ZOOM]
    assert reply.startswith("I went back to the view before. I zoomed in on the blue van")
    calls, reply = _replies("zoom in on the red van", "zoom in on the blue van", hidden="blue van", simulated=False)
    assert calls == [ZOOM]
    assert 'say "go back" first' in reply
    assert _replies("zoom in on the red van", "pan left 20", "zoom in on the blue van", hidden="blue van")[0] == [ZOOM]


@pytest.mark.parametrize(("pose", "viewpoint"), [(Pose(-50, 0, 4), None), (Pose(10, 0, 4), "bridge")])
def test_the_view_before_a_close_up_is_forgotten_when_the_camera_was_moved(pose: Pose, viewpoint: str | None) -> None:
    stage = _Yard(simulated=True, lands=Pose(10, 0, 4))
    turn = stage.turn("zoom in on the red van")
    assert view_before_close_ups((turn,), Pose(10, 0, 4), None) == Pose()
    assert view_before_close_ups((turn,), pose, viewpoint) is None
    stage.pose = Pose(-50, 0, 4)
    later = stage.turn("how many vans are there?", (turn,))
    assert view_before_close_ups((turn, later), Pose(-50, 0, 4), None) is None


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("how many people are in the left half?", "and in the right half?"),
         ["people in the left half", "people in the right half"]),
        (("how many people?", "how many of them are in the left half?", "and in the right half?"),
         ["people in the left half", "people in the right half"]),
        (("how many vans?", "and how many cars?"), ["vans", "cars"]),
    ],
)  # fmt: skip
@pytest.mark.parametrize("wording", ["so how many in total?", "how many altogether?", "sum them up"])
def test_only_counts_of_different_things_are_added(instructions: tuple[str, ...], wording: str, expected: list[str]) -> None:
    calls, reply = last_turn(*instructions, wording, count=4)
    assert [description for _, description in calls] == expected
    assert "which makes 8 altogether" in reply


def test_counts_at_presets_are_added_without_a_move() -> None:
    tour = ("how many cones are there at the gate?", "and at the highway?", "how many is that altogether?")
    calls, reply = last_turn(*tour, count=(4, 1))
    assert not calls
    assert reply.startswith("I counted 4 cones at gate and 1 at highway, which makes 5 altogether.")


def test_the_two_sides_that_were_counted_are_compared() -> None:
    turns = ("how many people are in the left half?", "and in the right half?", "which side has more?")
    calls, reply = last_turn(*turns, count=(4, 1, 4, 1))
    assert [name for name, _ in calls] == [COUNT, COUNT]
    assert "3 more people in the left half" in reply


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ("cars", "vans", True),
        ("cars", "vehicles", False),
        ("workers", "people", False),
        ("blue cars", "red cars", True),
        ("people in the left half", "people in the bottom half", False),
        ("people wearing helmets", "people wearing vests", False),
        ("closed doors", "shut doors", False),
        ("closed doors", "open doors", True),
        ("grey cars", "gray cars", False),
        ("full lorries", "loaded lorries", False),
        ("full lorries", "empty lorries", True),
        ("parked cars", "stationary cars", False),
        ("cyclists", "bicycles", False),
    ],
)
def test_descriptions_exclude_each_other(one: str, other: str, *, expected: bool) -> None:
    assert are_exclusive(one, other) is are_exclusive(other, one) is expected


@pytest.mark.parametrize(
    ("description", "predicate", "expected"),
    [
        ("open dock doors", "closed", "closed dock doors"),
        ("shut dock doors", "closed", "closed dock doors"),
        ("people with red jackets", "blue", "people with blue jackets"),
        ("sign on the green cabin", "blue", "sign on the blue cabin"),
        ("workers wearing helmets", "in the right half", "workers in the right half wearing helmets"),
    ],
)
def test_what_contradicts_a_predicate_is_replaced(description: str, predicate: str, expected: str) -> None:
    assert narrowed(description, predicate) == expected


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("how many workers?", "how many of them wear helmets?", "and in the left half?"),
         [(COUNT, "workers in the left half wearing helmets")]),
        (("how many cars and vans are there?", "and in the left half?"),
         [(COUNT, "cars in the left half"), (COUNT, "vans in the left half")]),
        (("how many cars?", "and the blue ones?", "how many of them are in the left half?"),
         [(COUNT, "blue cars in the left half")]),
        (("how many barrels are blue and how many red?",), [(COUNT, "blue barrels"), (COUNT, "red barrels")]),
        (("how many people have red jackets?", "and the blue ones?"), [(COUNT, "people with blue jackets")]),
        (("what does the sign on the green cabin say?", "and the blue one?"), [(ASK, "what does the sign on the blue cabin say?")]),
        (("who is wearing yellow?", "zoom in on the leftmost one"), [(ZOOM, "leftmost person wearing yellow")]),
    ],
)  # fmt: skip
def test_a_narrowing_is_kept(instructions: tuple[str, ...], expected: list[tuple[str, str]]) -> None:
    answer = "A man, a woman and a child are wearing yellow."
    assert last_turn(*instructions, count=3, answer=answer)[0] == expected


@pytest.mark.parametrize(
    ("instructions", "expected"),
    [
        (("how many helmets?", "what colours?"), (ASK, "what colour are the helmets?")),
        (("is the driver wearing a helmet?", "what colour?"), (ASK, "what colour is the helmet of the driver?")),
        (("how many doors are open?", "which ones?"), (ASK, "which open doors are there?")),
        (("how many lorries?", "which colour is most common?"), (ASK, "which colour of the lorries is most common?")),
        (("how many trams?", "is anyone waiting there?", "how many?"), (COUNT, "person waiting there")),
        (("how many trams?", "is anyone waiting there?", "any of them with luggage?"),
         (ASK, "any of the people waiting there with luggage?")),
        (("how many people?", "what about the taxis, how many are there?"), (COUNT, "taxis")),
        (("how many pigeons?", "nearest person?"), (ASK, "what is the nearest person?")),
        (("how many chairs?", "is anyone sitting?", "and standing?"), (ASK, "is anyone standing?")),
        (("how many cones?", "what does the sign say?", "and on the right?"), (ASK, "what does the sign on the right say?")),
        (("what does the sign say?", "and the other signs?"), (ASK, "what do the signs say?")),
        (("what is left of the roller?", "what is to the right of it?"), (ASK, "what is to the right of the roller?")),
        (("is there anyone with an umbrella?", "what colours are they?"), (ASK, "what colours is the umbrella?")),
        (("is there anyone with an umbrella?", "what colour is it?", "zoom in on the red one"), (ZOOM, "red umbrella")),
        (("find the cyclist", "what colour is his jacket?", "what about his bike?"), (ASK, "what colour is the cyclist's bike?")),
        (("is the man in the red helmet on the phone?", "zoom in on him"), (ZOOM, "man in the red helmet")),
        (("go to the gate", "zoom in on the first board", "and the next one?"), (ZOOM, "second board")),
        (("how many workers?", "show me the first one"), (ZOOM, "first worker")),
    ],
)  # fmt: skip
def test_what_a_follow_up_leaves_out(instructions: tuple[str, ...], expected: tuple[str, str]) -> None:
    assert last_turn(*instructions, count=3)[0][-1] == expected


def test_either_of_two_kinds_is_the_one_that_was_seen() -> None:
    answer = "Yes, there is a black dog at the bottom left."
    assert last_turn("is there a dog or a fox?", "where is it?", answer=answer)[0] == [(ASK, "where is the black dog?")]
    assert last_turn("are there any dogs?", "zoom in on it", answer="Yes, there is a black dog.")[0] == [(ZOOM, "dog")]


def test_the_next_one_of_no_order_is_asked_about() -> None:
    assert last_turn("zoom in on the red sign", "and the next one?") == ([], "Which sign do you mean? Please describe it.")


def test_a_thing_that_is_not_found_in_the_view_before_leaves_the_camera_there() -> None:
    stage = Stage([3, True, False], lands=Pose(20, -5, 4), simulated=True)
    first = stage.turn("how many workers are there?")
    second = stage.turn("zoom in on the left one", (first,))
    stage.lands = None
    reply = stage.run("and the one with the wheelbarrow?", (first, second)).text
    assert stage.pose == Pose()
    assert "so the camera is back at the view before" in reply
    assert "I went back" not in reply


@pytest.mark.parametrize("wording", ["how many are there in total?", "how many altogether?"])
def test_the_total_of_one_count_is_that_count(wording: str) -> None:
    assert last_turn("how many cars are there?", wording, count=3)[0] == [(COUNT, "cars")]
    assert not last_turn("how many vehicles are there?", "how many cars are there?", wording, count=3)[0]

"""Properties: any text gives a plan, spelled numbers keep their value, and calls always fit the tools."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.english.grammar.numbers import read_number
from scope_ptz.planner.grammar.lexing.lexicon import phrases
from scope_ptz.planner.plan import plan
from scope_ptz.tools.registry import TOOLS

PRESETS = ("gate", "highway")
MODELS = {name: tool.arguments for name, tool in TOOLS.items()}
ONES = [
    "zero",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
]
TENS = ["_", "_", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"]
PHRASES = sorted(" ".join(words) for words in phrases())
WORDS = st.sampled_from([*PHRASES, "20", "15.5", "cones", "the red car", "gate", ",", "and", "then", "?", ".", "-3", "2x", "50%"])


def spelled(number: int) -> str:
    if number < 20:
        return ONES[number]
    if number < 100:
        return TENS[number // 10] + (f" {ONES[number % 10]}" if number % 10 else "")
    rest = f" and {spelled(number % 100)}" if number % 100 else ""
    return f"{ONES[number // 100]} hundred{rest}"


def check(text: str) -> None:
    made = plan(text, PRESETS)
    assert made.understood == (made.clarification is None)
    assert made.understood or not made.calls
    for call in made.calls:
        MODELS[call.name].model_validate(call.arguments)
    assert plan(text, PRESETS) == made


@settings(max_examples=150, deadline=None)
@given(st.text(max_size=120))
def test_any_text_gives_a_plan(text: str) -> None:
    check(text)


@settings(max_examples=250, deadline=None)
@given(st.lists(WORDS, min_size=1, max_size=9).map(" ".join))
def test_any_words_of_the_language_give_a_plan(text: str) -> None:
    check(text)


@given(st.integers(0, 999))
def test_number_words_are_read(number: int) -> None:
    words = spelled(number).split()
    read = read_number(words)
    assert (read.value, read.used) == (number, len(words))


@given(st.integers(1, 170), st.sampled_from([("right", 1), ("left", -1)]))
def test_directions_are_never_inverted(degrees: int, way: tuple[str, int]) -> None:
    word, sign = way
    for text in (
        f"pan {word} {degrees}",
        f"turn the camera {degrees} degrees to the {word}",
        f"{degrees}° {word}",
        f"Please look {word} by {spelled(degrees)} degrees.",
    ):
        (call,) = plan(text, PRESETS).calls
        assert call.arguments == {"pan_deg": sign * degrees}, text


@given(st.integers(-170, 170), st.integers(-59, 29))
def test_absolute_targets_become_relative_moves(pan: int, tilt: int) -> None:
    from scope_ptz.geometry import Pose

    made = plan(f"set pan to {pan} and tilt to {tilt}", PRESETS, pose=Pose(5, -5, 2))
    arguments = made.calls[0].arguments if made.calls else {}
    assert arguments.get("pan_deg", 0) == pan - 5
    assert arguments.get("tilt_deg", 0) == tilt + 5

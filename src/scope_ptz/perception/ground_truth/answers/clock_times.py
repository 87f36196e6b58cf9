"""Answer what the hands of clocks show."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz import english
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, known_answer, position_words, unknown_answer
from scope_ptz.perception.ground_truth.view import Thing


def answer_clock_time(clocks: Sequence[Thing]) -> TruthAnswer:
    """Answer what the hands of clocks show, if their faces are large enough."""
    shown = [(t, str(t.attributes.get("time", t.attributes.get("shows", "")))) for t in clocks]
    stated = [(t, time) for t, time in shown if time]
    if not stated:
        return unknown_answer("I cannot tell the time from the clock hands")
    large = [(t, time) for t, time in stated if t.sighting.pixels >= _MIN_CLOCK_PX]
    if not large:
        return unknown_answer(
            "the clocks are too small to read" if len(stated) > 1 else f"the {stated[0][0].name} is too small to read"
        )
    if len(large) == 1:
        return known_answer(f"the {large[0][0].name} shows {large[0][1]}")
    return known_answer(english.listing([f"the {t.name} {position_words(t)} shows {time}" for t, time in large]))


_MIN_CLOCK_PX = 1200
"""Minimum number of visible pixels of a clock whose hands can be read, a face of about 40 x 40 pixels."""

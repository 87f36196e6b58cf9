"""Replies that say yes or no."""

from __future__ import annotations

import pytest

from scope_ptz.planner.confirmations import yes_or_no


@pytest.mark.parametrize("text", ["yes", "Yes.", "y", "yes please", "Yes, go ahead!", "ok", "sure, do it", "please do"])
def test_replies_that_agree(text: str) -> None:
    assert yes_or_no(text) == "yes"


@pytest.mark.parametrize("text", ["no", "No, thanks.", "nope", "cancel", "no thank you", "stop!"])
def test_replies_that_decline(text: str) -> None:
    assert yes_or_no(text) == "no"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "?",
        "yes, but only 10 degrees",
        "no, go home",
        "pan right 20",
        "yes and zoom in",
        "stop at the gate",
        "please",
        "right 20",
    ],
)
def test_other_texts_are_new_instructions(text: str) -> None:
    assert yes_or_no(text) is None

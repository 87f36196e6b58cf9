"""The sentence in which perception names the things that it could read from closer. The planner goes closer to these things."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz import english

MAX_NAMED = 4
"""Maximum number of things that the sentence names."""


@dataclass(frozen=True, slots=True)
class CloserViews:
    """The things of which a closer view may help.

    Attributes:
        things: Their descriptions without articles, the most promising one first.
        more: The number of further things, which are not named.
    """

    things: tuple[str, ...]
    more: int = 0


def closer_views_sentence(descriptions: Sequence[str]) -> str:
    """Return the sentence without its full stop; empty if there are no things. ``closer_views_in`` reads it back."""
    if not descriptions:
        return ""
    named, more = descriptions[:MAX_NAMED], len(descriptions) - MAX_NAMED
    listed = english.listing([f"the {description}" for description in named])
    return f"{_BEGINNING}{listed}{f', and with {more} more' if more > 0 else ''}"


def closer_views_in(answer: str) -> tuple[str, CloserViews | None]:
    """Return an answer without the sentence at its end, and what the sentence names; None if there is no such sentence."""
    match = _SENTENCE.search(answer)
    if match is None:
        return answer, None
    things = tuple(re.split(r",? and the |, the ", match["things"]))
    return answer[: match.start()].rstrip(), CloserViews(things, int(match["more"] or 0))


_BEGINNING = "A closer view may help with "
_SENTENCE = re.compile(rf"(?:^|(?<=\.)\s){_BEGINNING}the (?P<things>[^\n]+?)(?:, and with (?P<more>\d+) more)?\.?\Z")

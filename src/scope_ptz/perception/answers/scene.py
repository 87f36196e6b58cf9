"""What is to be seen as a whole, and what is going on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from scope_ptz.perception.answers.naming import Reply, name, place, reply
from scope_ptz.perception.answers.seeing import what
from scope_ptz.perception.facts import colour_of, fact_words
from scope_ptz.perception.language import syntax as s
from scope_ptz.perception.language import words as w
from scope_ptz.perception.matching import BACKDROP
from scope_ptz.perception.view import Thing, View

MAX_GROUPS = 10
MAX_TEXTS = 3
_ACTIVITY_KEYS = ("activity", "action", "doing", "task")


def describe(view: View, question: s.Describe) -> Reply:
    """What can be seen, biggest first, with the texts that can be read."""
    if question.tests:
        return what(view, s.What(s.Description((s.Phrase(("thing",)),)), question.tests))
    groups = _groups(t for t in view.top_level() if not t.concepts & BACKDROP)
    if not groups:
        return reply("I can see nothing that stands out")
    said = w.listing(groups[:MAX_GROUPS])
    texts = list(dict.fromkeys(t.text.text for t in view.texts if t.legible))[:MAX_TEXTS]
    readable = f". I can read {w.listing([f'{chr(34)}{t}{chr(34)}' for t in texts])}" if texts else ""
    return reply(f"I can see {said}{readable}")


def _groups(things: Iterable[Thing]) -> list[str]:
    """ "3 cars (2 white, 1 red)", largest on screen first."""
    by_kind: dict[str, list[Thing]] = {}
    for thing in sorted(things, key=lambda t: -t.sighting.pixels):
        by_kind.setdefault(thing.category, []).append(thing)
    said = []
    for kind, members in by_kind.items():
        if len(members) == 1:
            said.append(f"{w.article(name(members[0]))} {place(members[0])}")
            continue
        colours = Counter(c for c in map(colour_of, members) if c)
        shown = f" ({w.listing([f'{n} {c}' for c, n in colours.most_common()])})" if colours and len(colours) <= 4 else ""
        said.append(f"{w.counted(len(members), kind)}{shown}")
    return said


def happening(view: View, question: s.Happening) -> Reply:
    """Who and what moves or works; without that, what is to be seen."""
    busy = [f"{w.article(name(t))} is {doing}" for t in view.top_level() if (doing := _doing(t)) is not None]
    if not busy:
        return Reply(f"Nothing is moving. {describe(view, s.Describe()).text}")
    return reply(w.listing(busy[:MAX_GROUPS]))


def _doing(thing: Thing) -> str | None:
    for key in _ACTIVITY_KEYS:
        if key in thing.attributes:
            return str(thing.attributes[key])
    return "moving" if "moving" in fact_words(thing) else None

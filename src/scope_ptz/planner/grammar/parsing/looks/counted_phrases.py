"""Strip from what follows "how many" the words that only say who sees the things, who put them there, or that they are there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.parts_of_speech import verb_form
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import Source
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import is_noun_phrase
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

_HERE = "(VISIBLE|FILLER|NOW|FULL|there|present)*"
_OBSERVER = "(SELF|(DET)? (CAMERA|detector|software|system|model|program|computer|machine|scope))"
_PERCEIVES = "(SEE|FIND|COUNT|identify|distinguish|detect|detects|pick up|pick_up|pick_out|get|count|register|show)"
_ABLE = "(MODAL|BE able to|BE capable of|ADVERB|FILLER)*"
_OBSERVED = f"(?P<thing>_+?) (that|which|what)? (MODAL|DOV|do)? {_OBSERVER} {_ABLE} {_PERCEIVES} {_HERE}"
"""Things, and who sees them: "lane signals can the detector find", "floodlights that you can identify"."""

_NOTICED = "(identified|distinguished|detected|counted|recognised|recognized|spotted)"
_PERCEIVED = f"(?P<thing>_+?) (that|which|what)? (MODAL be|BE) {_NOTICED} {_HERE}"
"""Things, and that somebody sees them: "flags that can be identified"."""

_SOMEBODY = "(they|we|you|i|he|she|SOMEONE|SELF|(the|our|my) FREE{1,2}?)"
_PLACING = (
    "put_out|put_up|put_in|put_down|set_up|set_out|laid_out|left_out|got_out|(left|leave|got|get) (OUT|out|in|IN)|"
    "(put|set|laid|lay|brought|bring|stuck) (OUT|UP|DOWN|IN|out|up|down|in|over|along)?"
)
_WHERE = "(?P<where>((?!UP|DOWN) (PREP|VISIBLE|NOW|FULL|there) _*)?)"
_PLACED = f"(?P<thing>_+?) (HAVEV|DOV|do|have) {_SOMEBODY} (already|just)? ({_PLACING}) {_WHERE}"
"""Things, and who put them there: "traffic cones have they put out along the kerb"."""

_LEFT_SO = f"(?P<thing>_+?) (HAVEV|DOV|do|have) {_SOMEBODY} (leave|left) (?P<state>(FREE|ADVERB){{1,2}})"
"""Things, and the state that somebody left them in: "gates did they leave open"."""

_OWNED = f"(?P<thing>_+?) (HAVEV {_SOMEBODY} got|(DOV|do) {_SOMEBODY} (HAVEV|have) (got)?|SELF HAVEV got) (?P<doing>_+)"
"""Things that we have, and what they do: "people have we got queueing outside the bakery"."""

_PLACES = frozenset({"here", "there", "out", "in", "outside", "inside", "behind", "around", "about", "already", "over"})
"""Words after "left" that say where things are, or that there are some, and not in which state."""

_LOCATED = f"(?P<thing>_+?) BE (located|situated|positioned|present) {_WHERE}"
_POSTURES = frozenset({"sitting", "standing", "lying"})
_POSED = f"(?P<thing>_+?) ((DOV|do)? (stand|sit|lie)|BE (sitting|standing)) {_WHERE}"
"""Things, and their posture: "cabs are sitting by the wall". Of people and animals, it says more than that they are there."""


def without_presence(source: Source, lexemes: Sequence[Lexeme]) -> tuple[Source, tuple[Lexeme, ...]]:
    """Return the things to count, with what restricts them: "cones along the kerb" for "cones have they put out along the kerb".

    Args:
        source: The instruction.
        lexemes: The words after "how many" or "the number of".

    Returns:
        A source in which the other words are blank, and the lexemes of the things.
    """
    parts = _parts(tuple(lexemes))
    if parts is None or not parts[0] or not is_noun_phrase(parts[0]):
        return source, tuple(lexemes)
    thing, rest = parts
    if not rest:
        return source, tuple(thing)
    start, end = thing[-1].end, rest[0].start
    text = f"{source.text[:start]}{' ' * (end - start)}{source.text[end:]}"
    return replace(source, text=text), (*thing, *rest)


def _parts(lexemes: tuple[Lexeme, ...]) -> tuple[Sequence[Lexeme], Sequence[Lexeme]] | None:
    """Return the things and what restricts them, without the words between; None if there are no words to strip."""
    for pattern in (_OBSERVED, _PERCEIVED):
        if (seen := full_match(pattern, lexemes)) is not None:
            return seen["thing"], ()
    if (left := full_match(_LEFT_SO, lexemes)) is not None and left["state"][0].word not in _PLACES:
        verb = lexemes[len(left["thing"])]
        return left["thing"], (verb.reworded("are", "BE"), *left["state"])
    if (placed := full_match(_PLACED, lexemes)) is not None:
        return placed["thing"], placed["where"]
    if (owned := full_match(_OWNED, lexemes)) is not None:
        doing = owned["doing"][0]
        if doing.word in _POSTURES and _is_inanimate(owned["thing"][-1].word):
            return owned["thing"], owned["doing"][1:]  # "trailers do we have standing here"
        acts = doing.has("PREP") or verb_form(doing.word) in {"participle", "past"}
        return (owned["thing"], owned["doing"]) if acts else None
    posed = full_match(_POSED, lexemes)
    there = posed if posed is not None and _is_inanimate(posed["thing"][-1].word) else full_match(_LOCATED, lexemes)
    return (there["thing"], there["where"]) if there is not None else None


def _is_inanimate(noun: str) -> bool:
    """Return whether a noun is known to name a thing that is neither a person nor an animal."""
    concept = lexicon().concept(noun)
    return concept is not None and not {"person", "animal"} & lexicon().kinds(concept)

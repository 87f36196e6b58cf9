"""Read clauses that count things or check places for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from scope_ptz.english import is_plural, plural
from scope_ptz.english.grammar.parts_of_speech import verb_form
from scope_ptz.english.grammar.questions.recognition import looks_like_description
from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    AtPlaces,
    Count,
    Step,
    Thing,
    Unclear,
)
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.lexing.morphology import verb_forms
from scope_ptz.planner.grammar.parsing.calculations import without_sum
from scope_ptz.planner.grammar.parsing.looks.counted_phrases import without_presence
from scope_ptz.planner.grammar.parsing.parts.clause import ME, SKIP, Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import (
    is_noun,
    is_noun_phrase,
    thing_of,
    things_of,
    without_function_words,
)
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of, places_of
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, without_view

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View


_LOOKING = r"(got|HAVEV|TELL|TELL-ING|COUNT|COUNT-ING|SHOW|TAKE|DESCRIBE|READ|SEE|have|AIM|do|give|get|CARRY|LISTING|FIND|and|DET)"


_SEEING = (
    r"(BE (there)? VISIBLE?|BE there|(can|do|did|could) SELF (ADVERB|FILLER)* (SEE|COUNT|READ|FIND|make out|get)|there BE|SELF "
    r"(can|could|do|have)? (SEE|have|got (up|out|over)?)|HAVEV SELF (got (up|out|over)?)?|do we have|"
    r"can be SEE-ED|can be seen|BE VISIBLE|"
    r"are we (SEE-ING|AIM-ING at)|you are SEE-ING|exist|VISIBLE|BE|in total|in all|(what|that)? SELF (can)? (SEE|FIND)|"
    r"altogether)"
)


_READING = "(can|could) SELF (ADVERB|FILLER)* READ (VISIBLE|FILLER|NOW|out|there)*"


_SUBJECTS = frozenset({"we", "i", "you", "they", "he", "she"})
_WRITTEN = frozenset({
    "words", "letters", "numbers", "digits", "figures", "characters", "names", "lines", "plates", "registrations", "prices",
    "labels",
})  # fmt: skip
_IN_ALL = "in_total|in total|altogether|in_all|in all|overall"


_PLACED_BETWEEN = (
    "(?P<first>FREE{1,3}) (at|in|on) (?P<place>(DET)? PRESET) COMMA? AND (?P<second>DET FREE{1,3}) (too|as_well|also)+"
)
"""Things at a preset, and more of them that are counted there too: "kids in the pool and the adults too"."""

_WITH_PART = {
    "wear": "wearing",
    "have": "with",
    "carry": "carrying",
    "hold": "holding",
    "ride": "riding",
    "sit": "sitting",
    "stand": "standing",
}
_KIND_OF_COUNT = "total|exact|overall|rough|approximate|precise|current|quick|estimated|full"


def count_step(source: Source, lexemes: Sequence[Lexeme], view: View | None) -> Step | tuple[Step, ...] | None:
    """Read "count the cars", "how many cars are there" and "the number of cars"."""
    if match := full_match(
        rf"{SKIP} (of|OFNOUN|out_of|among) (EVERY|DET|all)* (?P<whole>_+?) (COMMA)? HOWMANY (of "
        rf"(PRON|those))? (?P<rest>_+)",
        lexemes,
    ):
        part = _WITH_PART.get(match["rest"][0].word)
        if part is None:
            return _count_with_predicate(source, (*match["whole"], *match["rest"]), view)
        whole = thing_of(source, trimmed(match["whole"], "VISIBLE"))  # "of the people in view, how many wear a hat?"
        return Count((Thing(f"{whole.text} {part} {text_of(source, match['rest'][1:])}"),), view) if whole and whole.text else None
    compared = full_match(
        rf"{SKIP} {ME} HOWMANY (?P<thing>_+?) (BE there|BE VISIBLE|BE)? (at|on|in) (?P<first>DET? PRESET) COMMA? THAN "
        "(at|on|in)? (?P<second>DET? PRESET) (FILLER)*",
        lexemes,
    )
    if compared is not None and (thing := thing_of(source, compared["thing"])) is not None:
        first, second = place_of(source, compared["first"]), place_of(source, compared["second"])
        return AtPlaces((first, second), (Count((thing,)),)) if first and second else None  # "how many ... in A compared to B?"
    if match := full_match(rf"{SKIP} {_LOOKING}* {ME} HOWMANYMORE (?P<first>_+) than (?P<second>_+)", lexemes):
        return None
    if match := full_match(
        rf"{SKIP} ({_LOOKING}|{ME}|WHQ|BE|DET|that|about|roughly|around|EXACTLY)* (?P<how>HOWMANY) (?P<rest>_+)", lexemes
    ):
        if match["how"][0].word in {"how much", "how_much"} and match["rest"][0].word == "of":
            return None  # "how much of the blade is iced" asks for a proportion
        legible = full_match(f"(?P<thing>_+) {_READING}", match["rest"])
        if legible is not None and not _is_made_out(legible["thing"], match["rest"]):
            return Ask(f"How many {text_of(source, match['rest'])}?", view)  # only perception knows which text is legible
        return _counted(source, match["rest"], view, lexemes, match["how"][0])
    if full_match(rf"{SKIP} HOWMANY {SKIP}", lexemes):
        return Count((Thing(),), view)
    if match := full_match(
        rf"{SKIP} ({_LOOKING}|{ME}|WHQ BE|DET|{_KIND_OF_COUNT})* COUNTNOUN (me|us)? (EVERY|DET|all)? (?P<rest>_+)", lexemes
    ):
        return _counted(source, match["rest"], view, lexemes, None)
    if match := full_match(
        rf"{SKIP} (do|TAKE|CARRY)? {ME} DET? (?P<thing>FREE{{1,2}}) (count|headcount) (of)? (VISIBLE|FILLER)*", lexemes
    ):
        counted = _counted(source, match["thing"], view, lexemes, None)
        if isinstance(counted, Count):
            return replace(counted, things=tuple(replace(thing, text=_several(thing.text)) for thing in counted.things))
        return counted  # "people count", "vehicle count"
    if match := full_match(rf"{SKIP} (do|TAKE|CARRY)? DET? (headcount|head_count) (of|on|for)? (?P<rest>_+)", lexemes):
        if place_of(source, match["rest"]) is not None:
            return None  # "a headcount on the bridge" does not say what to count
        listed = full_match("(?P<place>(DET)? PRESET PRESETNOUN?) COMMA (?P<things>_+)", match["rest"])
        if listed and (place := place_of(source, listed["place"])) is not None:
            things = things_of(source, without_sum(listed["things"]))
            return AtPlaces((place,), (Count(things, view),)) if things else None
        return _counted(source, match["rest"], view, lexemes, None)
    if match := full_match(r"(?P<rest>_+) (COMMA|DASH) (DET)? (number|count|total|headcount|tally)", lexemes):
        return _counted(source, match["rest"], view, lexemes, None)  # "persons in frame, number?"
    if match := full_match(rf"{SKIP} (COUNT|COUNT-ING) {ME} (?P<rest>_+)", lexemes):
        if match["rest"][0].has("NUM", "to") and not match["rest"][0].has("DET") and len(match["rest"]) < 3:
            return None
        return _counted(source, match["rest"], view, lexemes, None)
    return None


def _several(things: str) -> str:
    """Return the plural of a description: "vehicles" for "vehicle"."""
    return things if is_plural(things.lower().split()[-1]) else plural(things)


def _is_made_out(things: Sequence[Lexeme], lexemes: Sequence[Lexeme]) -> bool:
    """Return whether things other than writing are made out: "wagons can you make out", unlike "words can you make out"."""
    return any(x.word == "make_out" for x in lexemes) and things[-1].word not in _WRITTEN


def _counted(
    source: Source, rest: Sequence[Lexeme], view: View | None, lexemes: Sequence[Lexeme], how: Lexeme | None
) -> Step | tuple[Step, ...] | None:
    """Return the count of what follows "how many" or "count"."""
    if view is None and has_full_scope(lexemes):
        view = "full"
    if (aside := full_match(f"(?P<thing>_+?) COMMA (?P<sum>{_IN_ALL}) COMMA (?P<rest>_+)", rest)) is not None:
        rest = (*aside["thing"], *aside["rest"])  # "how many vans, in total, can be seen?"
    if (kinds := full_match(f"(?P<thing>_+) ({_IN_ALL}) COMMA _+ AND (DET)? (others|other|rest)", rest)) is not None:
        rest = kinds["thing"]  # "how many cars are there altogether, taxis and others?"
    if (
        guess := full_match("(?P<thing>_+?) (would_you|MODAL SELF|do SELF) (say|reckon|think|guess) (?P<rest>_*)", rest)
    ) is not None:
        rest = (*guess["thing"], *guess["rest"])  # "how many lorries would you say there are?"
    if full_match("_+ in (AMOUNTISH|DET)* NUM (MINUTES|HOURS)", rest):
        return Unclear("I cannot wait. Shall I count them now?")  # "count the vans in ten minutes"
    rest = trimmed(rest, "FILLER", "COMMA", "ALSO")
    if (both := full_match(_PLACED_BETWEEN, rest)) is not None:
        first, second = things_of(source, both["first"]), things_of(source, both["second"])
        place = place_of(source, both["place"])
        if place is not None and first and second and is_plural(both["second"][-1].word):
            return AtPlaces((place,), (Count((*first, *second), view),))
    if source.has_moved and (turned := full_match("(?P<thing>_+) (over)? (on|in) (this|that) (SIDE|direction)", rest)) is not None:
        rest = turned["thing"]  # "turn around and count the tents on that side"
    while len(rest) > 1 and rest[-1].word in {"too", "as_well", "also", "total"}:
        rest = rest[:-1]
    if (until_now := full_match("(?P<thing>_+) so far", rest)) is not None:
        rest = until_now["thing"]  # "how many vans are there so far?"
    source, rest = without_presence(source, trimmed(without_sum(rest), "FILLER", "COMMA", "AMOUNTISH"))
    rest, inner = without_view(rest)
    view = view or inner
    if full_match(
        r"of? (of them|PRON|of those|more|there|BE|VISIBLE|SELF|can|SEE|now|NOW|are|again|HAVEV|got|have)*", rest
    ) and not any(x.has("FREE") for x in rest):
        return Count((Thing(),), view)
    if how is not None and (share := _share_of_last(source, rest)) is not None:
        return Count((share,), view)
    # "How many people wait?" counts people waiting.
    if (acting := full_match("(?P<thing>FREE{1,3}) (?P<verb>FREE)", rest)) is not None and how is not None:
        verb = acting["verb"][0].word
        if verb_form(verb) == "base" and is_plural(acting["thing"][-1].word):
            return Count((Thing(f"{text_of(source, acting['thing'])} {verb_forms(verb)['ing'][0]}"),), view)
    if match := full_match(
        rf"(?P<thing>_+?) {_SEEING}+ (VISIBLE|FILLER|FULL|NOW|there|altogether|present|out there|out|INTURN)*", rest
    ):
        things = things_of(source, match["thing"])
        if things:
            return Count(things, view)
    if how is not None and rest[0].has("PREP") and (places := places_of(source, rest)):
        return AtPlaces(places, (Count((Thing("people"),), view),))  # "how many on the boardwalk?"
    if how is not None and match_start("(in|on|at) DET FREE", rest):
        return Count((Thing(f"people {text_of(source, rest)}"),), view)  # "how many in the queue?"
    if how is not None and (those := _count_with_predicate(source, rest, view)):
        return those
    if things := things_of(source, rest):
        return Count(things, view)
    return None


def _share_of_last(source: Source, rest: Sequence[Lexeme]) -> Thing | None:
    """Read "of them are walking" and "of those wear helmets" as a share of the things that were spoken about last."""
    verbs = "wear|carry|hold|ride|sit|stand|walk|face|has|have|do not|does not"
    match = full_match(f"(of)? (?P<those>them|those|these) (?P<predicate>(BE|HAVEV|DOV|{verbs}) (?P<rest>_+))", rest)
    if match is None or match["rest"][0].has("VISIBLE", "SELF") or match["rest"][0].word == "there":
        return None
    if search("PAN|TILT|ZOOM|IF|DEG|THEN|(COMMA|AND) WHQ", rest):
        return None
    is_kind = match["predicate"][0].has("BE") and is_plural(match["rest"][-1].word) and is_noun_phrase(match["rest"])
    if is_kind:
        return None  # "how many of them are reefers"
    return Thing(pronoun=match["those"][0].word, predicate=text_of(source, match["predicate"]))


def _count_with_predicate(source: Source, rest: Sequence[Lexeme], view: View | None) -> Step | None:
    """Read "how many cars are in the left lane" or "... are red" as a count whose description includes the predicate."""
    if match := full_match(
        r"(?P<part>_+?) (does|do|has|have) (?P<whole>_+?) (have|got|show|contain)|(?P<part>_+?) (has|have) (?P<whole>DET PRESET)",
        rest,
    ):
        part, whole = thing_of(source, match["part"]), thing_of(source, match["whole"])
        if part and (place := place_of(source, match["whole"])) is not None:
            return AtPlaces((place,), (Count((part,), view),))  # "how many windows does the back gate have?"
        return Count((Thing(f"{part.text} of the {whole.text}"),), view) if part and whole else None
    match = full_match(
        (
            r"(?P<thing>_+?) (?P<verb>(can SELF SEE|do SELF SEE|BE there|BE VISIBLE|BE|HAVEV|do|does|DOV)) "
            r"(?P<not>not)? (?P<main>have|wear|be)? (got)? (?P<rest>_+)"
        ),
        rest,
    )
    if not match or not (thing := thing_of(source, match["thing"])):
        return None
    words, verb = trimmed(match["rest"], "FILLER"), match["verb"]
    if words[:1] and words[0].word == "been" and len(words) > 1:
        return Count(
            (Thing(without_function_words(f"{thing.text} {text_of(source, words[1:])}")),), view
        )  # "... have been left in the shed"
    text = text_of(source, words)
    negated = match.has("not")
    if any(x.has("PAN", "TILT", "ZOOM", "IF", "DEG", "THEN") for x in words) or search("(COMMA|AND) WHQ", words):
        return None
    if words and (words[0].word in _SUBJECTS or (verb[0].has("DOV") and words[0].has("DET") and not match.has("main"))):
        return None  # "how many gates did they leave open" asks what somebody did
    if not thing.text and not negated and words and is_plural(words[-1].word) and is_noun_phrase(words):
        return Count((Thing(text),), view)  # "how many of them are reefers"
    if not thing.text:
        is_acting = bool(words) and words[0].word.endswith("ing")
        return Count(
            (Thing(f"ones {'not ' if negated else ''}{text}" if is_acting else f"{'not ' if negated else ''}{text} ones"),), view
        )
    if any(x.has("HAVEV", "DOV") for x in verb) and not any(x.has("BE", "SELF") for x in verb):
        return Count((Thing(f"{thing.text} {'without' if negated else 'with'} {text}"),), view)
    if len(words) == 1 and words[0].has("FREE") and is_plural(text) and is_noun(words[0].word) and not negated:
        return Count((Thing(text),), view)  # "how many of the people are children?"
    adjective = (
        len(words) == 1 and (words[0].has("FREE") or words[0].word in {"open", "shut"}) and not text.endswith("ing") and not negated
    )
    description = without_function_words(f"{text} {thing.text}" if adjective else f"{thing.text} {'not ' if negated else ''}{text}")
    return Count((Thing(description),), view) if looks_like_description(description) else None


def check_places_step(source: Source, lexemes: Sequence[Lexeme]) -> Step | None:
    """Read "check the gate and the yard for people"."""
    if (bare := full_match(rf"{SKIP} ((check|TELL|scan|SCAN) for|presence check (for|of)?) (?P<things>_+)", lexemes)) is not None:
        things = things_of(source, bare["things"])
        return Count(things, "full" if lexemes[0].has("SCAN") else None) if things else None  # "check for smoke"
    if (wide := full_match(rf"{SKIP} (check|look|SCAN|TELL|search) FULL for (?P<things>_+)", lexemes)) is not None:
        things = things_of(source, wide["things"])
        return Count(things, "full") if things else None
    match = full_match(
        (
            rf"{SKIP} (check|look at|look in|search|inspect|look in on|SCAN|check out|have a look at|take a look at) "
            rf"(?P<places>_+?) for (?P<things>_+)"
        ),
        lexemes,
    )
    if not match:
        return None
    places, things = places_of(source, match["places"]), things_of(source, match["things"])
    if any(x.has("SECONDS", "MINUTES") for x in match["things"]):
        return None
    return AtPlaces(places, (Count(things),)) if places is not None and things else None

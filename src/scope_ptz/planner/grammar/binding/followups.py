"""Read short follow-ups, which leave out what the last look was about: "and in the right half?", "now the silver one", "where?"."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.english import COLOURS
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.questions.recognition import is_description
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.narrowing import names_region
from scope_ptz.planner.grammar.binding.noun_heads import has_one, is_ranked
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.instruction_parser import parse
from scope_ptz.planner.grammar.parsing.parts.clause import Source, text_of, trimmed
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, search

_LEAD = "(FILLER|COMMA|AND|BUT|NOW|LEADFILLER|FIRSTLY|now|ok|okay|then|so|also|what_about|how_about)*"
_REJECTING = "(FILLER|COMMA)* (no|nope|nah|sorry|oops) ((COMMA|DASH)+|(?=the))"
"""The beginning of a follow-up that corrects the turn before: "no, the woman on the left"."""

_LEAD_ABOUT = "(FILLER|COMMA|AND|BUT|now|so|ok|okay|then)* (what_about|how_about)"
_LEAD_DIRECTION = "(FILLER|COMMA|AND|BUT|now|so|ok|okay|then|what_about|how_about|what|is|BE)*"
_TO_SIDE = "(to|on|at)? (DET|its|his|her|their)? (?P<side>LEFT|RIGHT|left|right) (SIDE|side|hand)*"
_BEYOND = "(?P<place>above|below|behind|underneath|beneath)"
_IN_FRONT = "in DET? front|in_front"
_SIDE = "left|right|middle|centre|center|top|bottom"
_APOLOGIES = frozenset({"sorry", "oops", "my_mistake"})
"""Courtesy before a follow-up that corrects the turn before: "sorry, the right half"."""

_END = "(FILLER|COMMA|QUESTION|STOP|NOW|then|VISIBLE)*"
_SHOW = "((ZOOM IN|ZOOM_IN) (on|onto|to)|show (me|us)?|SHOW (me|us)?|look at|LOOK_AT)"
_DETERMINER = "(DET|EVERY)"
_PREPOSITIONS = frozenset({
    "in", "on", "at", "near", "behind", "beside", "under", "above", "below", "between", "inside", "outside", "with", "without",
    "by", "to", "next",
})  # fmt: skip
WHERE = "where?"
"""The question that leaves out the thing, which is that of the turn before."""

_MAX_LEXEMES = 12  # longer texts are not short follow-ups


def followup_of(text: str, presets: tuple[str, ...]) -> tuple[ast.Step, ...] | None:
    """Return the step of a short follow-up; None for other texts.

    Args:
        text: The user's text, which is no instruction on its own.
        presets: The camera's presets.
    """
    lexemes = trimmed(lexemes_of(text, presets), "STOP", "QUESTION")
    if not 0 < len(lexemes) <= _MAX_LEXEMES:
        return None
    step = _followup(Source(text, presets), lexemes)
    return (step,) if step is not None else None


def _followup(source: Source, lexemes: Sequence[Lexeme]) -> ast.Step | None:
    if full_match(f"{_LEAD} (where|where_is) (PRON|exactly|BE)* {_END}", lexemes):
        return ast.Ask(WHERE)
    if full_match(f"{_LEAD} READ (them|those|these|both|all) (of|all|both|them|those|these|out|aloud)* {_END}", lexemes):
        return ast.Read(ast.Thing(pronoun="them"))
    if (chosen := full_match(f"{_LEAD} {_SHOW} (?P<which>one|both|all|each) (of)? (PRON|DET two)? {_END}", lexemes)) is not None:
        return ast.ZoomTo(ast.Thing(pronoun="one" if chosen["which"][0].word == "one" else "both"))
    if full_match(f"{_LEAD} look at_both (of)? (PRON)? {_END}", lexemes):
        return ast.ZoomTo(ast.Thing(pronoun="both"))
    if search("one of (them|those|these)", lexemes):
        return ast.Unclear("Which one do you mean? Please describe it.")
    if any_of := full_match(
        f"{_LEAD} any (of them|of those)? (?P<predicate>(PREP|in|with|without|wearing|not)? _+) {_END}", lexemes
    ):
        predicate = text_of(source, any_of["predicate"])
        return ast.Ask(f"any of them {predicate}?") if is_predicate(predicate) else None
    if full_match(f"{_LEAD} (altogether|together|in_total|in_all|in total|in all|combined|total) {_END}", lexemes):
        return ast.Total(())
    if fronted := full_match(f"{_LEAD} (?P<place>PREP _+?) COMMA (?P<count>HOWMANY _+)", lexemes):
        return _count_in(text_of(source, fronted["place"]), text_of(source, fronted["count"]), source.presets)
    match = full_match(f"(?P<lead>({_REJECTING})? {_LEAD}) (?P<what>_+?) {_END}", lexemes)
    if match is None or any(x.has("COMMA") for x in match["what"]):
        return None
    lead = match["lead"] if match.has("lead") else ()
    what, is_led = match["what"], any(x.word in _APOLOGIES or not x.has("FILLER", "COMMA") for x in lead)
    if full_match("(all|both|each)? (of)? PRON (all|both)?|(both|all|each)", what):
        pronoun = next((x.word for x in what if x.has("PRON")), "them")
        return ast.WhatAbout(ast.Thing(pronoun=pronoun if is_led else "both")) if is_led or len(what) > 1 else None
    phrase = full_match(f"{_DETERMINER} (?P<noun>_+)", what)
    if phrase is not None:
        noun_phrase = text_of(source, phrase["noun"])
        is_one = any(x.word in {"one", "ones"} for x in phrase["noun"])
        if is_other(noun_phrase):
            return ast.WhatAbout(ast.Thing(noun_phrase, definite=True))
        if is_led and names_region(noun_phrase):
            return ast.WhatAbout(ast.Thing(predicate=f"in the {noun_phrase}"))
        return ast.WhatAbout(ast.Thing(noun_phrase, definite=True)) if is_one or (is_led and is_description(noun_phrase)) else None
    predicate = text_of(source, what)
    if is_ranked(predicate) and is_description(predicate) and not has_one(predicate) and source.text.rstrip().endswith("?"):
        return ast.Ask(f"what is the {predicate}?")
    return ast.WhatAbout(ast.Thing(predicate=predicate)) if is_led and is_predicate(predicate) else None


def question_about_side(text: str, presets: tuple[str, ...]) -> tuple[ast.Step, ...] | None:
    """Return the step of "what about the right?", which asks about a side of the picture; None for other texts."""
    match = full_match(f"{_LEAD_ABOUT} (PREP|on|at|in)* DET? (?P<side>{_SIDE}) (side|hand)* {_END}", lexemes_of(text, presets))
    if match is None:
        return None
    side = match["side"][0].word
    place = (
        f"in the {side}" if side in {"middle", "centre", "center"} else f"{'on' if side in {'left', 'right'} else 'at'} the {side}"
    )
    return (ast.WhatAbout(ast.Thing(predicate=place)),)


def question_in_other_direction(text: str, presets: tuple[str, ...]) -> tuple[ast.Step, ...] | None:
    """Return the step of "and to the right?" after "what is to the left of the van?"; None for other texts."""
    pattern = f"{_LEAD_DIRECTION} ({_TO_SIDE}|{_BEYOND}|{_IN_FRONT}) (of it|it|FILLER|QUESTION|STOP)*"
    match = full_match(pattern, lexemes_of(text, presets))
    if match is None or text.strip(" .?!").lower() in {"left", "right"}:
        return None
    if match.has("side"):
        place = f"to the {match['side'][0].word} of"
    else:
        place = match["place"][0].word if match.has("place") else "in front of"
    return (ast.WhatAbout(ast.Thing(predicate=f"{place} it")),)


def is_return_to_centre(text: str) -> bool:
    """Return whether a whole text asks to go back to "the centre", which has no single meaning: "now back to centre"."""
    return (
        full_match(
            "(FILLER|COMMA|STOP|AND|NOW|THEN)* (go|come|CARRY|TURN|PAN)? (BACK|SWITCH|go_back)+ to CENTREWORD (FILLER|STOP|COMMA)*",
            lexemes_of(text),
        )
        is not None
    )


def question_about_topic(text: str, presets: tuple[str, ...]) -> tuple[ast.Step, ...] | None:
    """Return the steps of "what about the left one, what colour is it?": the thing, and the question about it; None for others."""
    lexemes = trimmed(lexemes_of(text, presets), "STOP", "QUESTION")
    if not 0 < len(lexemes) <= _MAX_LEXEMES + 4:
        return None
    match = full_match(f"{_LEAD_ABOUT} DET (?P<noun>_+?) (COMMA|DASH|QUESTION)+ (AND)? (?P<asked>_+)", lexemes)
    if match is None or not any(x.has("PRON", "HOWMANY") for x in match["asked"]) or any(x.has("COMMA") for x in match["noun"]):
        return None
    source = Source(text, presets)
    asked = parse(f"{text_of(source, match['asked'])}?", presets).steps or ()
    if not asked or not all(isinstance(step, ast.Ask | ast.Count | ast.Read) for step in asked):
        return None
    return (ast.Mention(ast.Thing(text_of(source, match["noun"]), definite=True)), *asked)


def _count_in(place: str, count: str, presets: tuple[str, ...]) -> ast.Step | None:
    """Return the count of "in the right half, how many people?"; None if the words are no count and a place in the picture."""
    steps = parse(f"{count}?", presets).steps or ()
    if len(steps) != 1 or not isinstance(steps[0], ast.Count) or len(steps[0].things) != 1 or not is_predicate(place):
        return None
    thing = steps[0].things[0]
    described = ast.Thing(f"{thing.text} {place}") if thing.text else ast.Thing(pronoun="them", predicate=place)
    return ast.Count((described,), steps[0].view)


def is_other(noun_phrase: str) -> bool:
    """Return whether a noun phrase is "the other one", "the others" or "the other dog"."""
    return noun_phrase.lower().split(" ")[0] in {"other", "others"}


def is_predicate(text: str) -> bool:
    """Return whether text says something about a thing without naming one: "in the right half", "standing", "blue"."""
    words = text.lower().split(" ")
    if words[0] in {"one", "ones"}:
        return False
    if len(words) == 1:
        return words[0] in COLOURS or words[0].endswith("ing") or is_adjective(words[0])
    is_modifier = words[0].endswith("ing") or words[0] in _PREPOSITIONS or words[0] == "not"
    return is_modifier and is_description(f"thing {text}")


def is_adjective(word: str) -> bool:
    """Return whether a word can only be an adjective, and names no thing."""
    is_noun = lexicon().concept(word) is not None or is_common_noun(word)
    return word in COLOURS or ("ADJ" in parts_of_speech(word) and not is_noun)

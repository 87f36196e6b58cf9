"""Rewrite wordings in which only the name of a preset shows what is meant."""

from __future__ import annotations

import re
from functools import lru_cache

from scope_ptz.english import is_plural, plural
from scope_ptz.planner.grammar.lexing.preset_names import short_names
from scope_ptz.planner.grammar.parsing.remark_detection.surrounding_remarks import asks_for_something
from scope_ptz.planner.grammar.parsing.rewording.preset_comparisons import with_presets_compared
from scope_ptz.planner.grammar.parsing.rewording.preset_groups import with_groups_named
from scope_ptz.planner.grammar.parsing.rewording.tables.counts import NO_TOPIC

_STATES = (
    "open|shut|closed|locked|unlocked|clear|empty|full|free|busy|quiet|blocked|wet|dry|lit|occupied|flooded|icy|manned|staffed|"
    "on|off|up|down|raised|lowered"
)
_TOUR = re.compile(r"\b(?:each|every|all)\b", re.IGNORECASE)
_PICTURES = r"(?:photo|photograph|picture|pic|snap|shot|still|image)"
_COUNTS = r"(?:how many|number of|count(?: the)?|total(?: of)?)"


@lru_cache(maxsize=64)
def _names(presets: tuple[str, ...]) -> str:
    """Return a pattern for the names of the presets, with spaces or hyphens between their words."""
    presets = (*presets, *short_names(presets))
    each = (r"[-_ ]".join(re.escape(word) for word in re.findall(r"[^\W_]+", preset)) for preset in presets)
    return "|".join(sorted((name for name in each if name), key=len, reverse=True))


def with_places_named(text: str, presets: tuple[str, ...]) -> str:
    """Return "count the vans at the yard" for "vans count, yard", "is the yard clear?" for "yard clear?", and so on."""
    text = with_groups_named(text, presets)
    words = set(re.findall(r"[^\W_]+", text.lower()))
    if not any(words & set(re.findall(r"[^\W_]+", preset.lower())) for preset in presets):
        return text
    names = _names(presets)
    text = with_presets_compared(_without_apostrophes(text, presets), names)
    for pattern, plain in (
        (rf"^right,? (?=(?:the )?(?:{names}) first\b)", ""),
        (rf"^(?:the )?({names}) first, (?:then )?", r"go to the \1, then "),
        (
            rf"^(?:does|do|has|have) (?:the )?({names}) or (?:the )?({names}) (?:have|got|has|hold) (more|fewer) ([\w ]+?)(?: "
            rf"in it| there| on it)?\?*$",
            r"which has \3 \4, \1 or \2?",
        ),
        (rf"^(?:the )?({names})[,.] go\W*$", r"go to the \1"),
        (rf"^(?:stick|put|get) (?:her|it|him|the camera) on (?:the )?({names})\b", r"go to the \1"),
        (rf"\b(nip|pop|go|run) (?:over|up|down|across) (?:the )?(?=(?:{names})\b)", r"\1 over to the "),
        (
            rf"^more ([\w ]+?) where[,:]? (?:the )?({names}) or (?:the )?({names})\W*$|"
            rf"^([\w -]+): (?:the )?({names}) (?:vs\.?|or|versus) (?:the )?({names}),? which has more\W*$",
            lambda match: f"which has more {match[1] or match[4]}, {match[2] or match[5]} or {match[3] or match[6]}?",
        ),
        (
            rf"^compare how many ([\w ]+?)(?: (?:is|are)(?: standing?| standin| there| parked)?)? (?:in|at|on) (?:the )?({names}) "
            rf"(?:against|with|to|and|versus) (?:the )?({names})\W*$",
            r"which has more \1, \2 or \3?",
        ),
        (
            rf"[.,] (?:never mind|forget|ignore|not) (?:about )?the ({names})\W*$",
            lambda match: match[0] if match[1].lower() in match.string[: match.start()].lower() else "",
        ),
        (
            rf"^(?:after|once) you(?:['’]ve| have) been to (?:the )?({names}) and counted (the [\w ]+?), ",
            r"go to the \1, count \2, then ",
        ),
        (
            rf"^.*[,.;] *(?:(?:oh|i['’]m sorry|sorry|no|actually)[, ]+)+forget that, (?:the )?({names}) (?:would"
            rf"|might|will) be (?:more helpful"
            rf"|better|more useful|preferable)\W*$",
            r"go to the \1",
        ),
        (rf"\blet['’]?s have (?:the )?({names})(?: up| on| on screen)*(?:, shall we)?(?=\W*$|,)", r"go to the \1"),
        (
            rf"^(?:the )?([\w ]+?) ({_STATES}) (at|in|on) (?:the )?({names})\?+$",
            lambda match: (
                match[0]
                if NO_TOPIC.search(match[1])
                else f"{'are' if is_plural(match[1].split(' ')[-1]) else 'is'} the {match[1]} at the {match[4]} {match[2]}?"
            ),
        ),
        (
            rf"\b(photograph|take a picture of) (?:the )?({names})([^,]*), and (?:then )?(?:the )?({names}) likewise",
            r"\1 the \2 and the \4",
        ),
        (rf"^(?:the )?({names}) (\w+ing|\w+ed) or (\w+ed|\w+ing)\?$", r"is the \1 \2 or \3?"),
        (
            rf"^(?:the )?([\w ]+?) (at|in|on) (?:the )?({names}), (\w+) or (\w+)\W*$",
            lambda match: (
                match[0]
                if NO_TOPIC.search(match[1])
                else f"{'are' if is_plural(match[1].split(' ')[-1]) else 'is'} the {match[1]} at the {match[3]} "
                f"{match[4]} or {match[5]}?"
            ),
        ),
        (
            rf"^(?:the )?([\w ]+?) (at|in|on) (?:the )?({names}), what does it (read|say|show)\W*$",
            r"what does the \1 at the \3 \4?",
        ),
        (rf"^queue (at|in|on) (?:the )?({names}), how many (\w+)\W*$", r"count the \3 at the \2"),
        (
            rf"^show me (?:the )?({names}),? then (?:the )?({names})\. no, leave the \w+ out, just (?:the )?({names})\W*$",
            r"go to the \3",
        ),
        (
            rf",? (?:(?:but|and) )?(?:skip|leave out|miss out|ignore|(?:don['’]?t|do not) (?:stop at|go to|do|visit)|not"
            rf"|no need to (?:do|visit|go to)) (?:the )?({names})\W*$",
            lambda match: f" except the {match[1]}" if _TOUR.search(match.string) else match[0],
        ),
        (rf"^((?:(?!\b(?:each|every|all)\b).)*?),? but (?:skip|not|leave out|ignore) (?:the )?(?:{names})\W*$", r"\1"),
        (
            rf"\bif there (?:are|is) (more|fewer) ([\w ]+?) (?:at|in|on) (?:the )?({names}) than (?:at |in |on )?"
            rf"(?:the )?({names})\b",
            r"if the \3 has \1 \2 than the \4",
        ),
        (rf"^(?:after|once) you(?:['’]ve| have) been to (?:the )?({names}), ", r"go to the \1, then "),
        (rf"^head ?count[,:]? (?:at )?(?:the )?({names})\W*$", r"how many people are at the \1?"),
        (
            rf"^is it (?:the )?({names}) or (?:the )?({names}) that has (?:the )?(?:more|most|greater number of"
            rf"|larger number of) ([\w ]+?)\?*$",
            r"which has more \3, \1 or \2?",
        ),
        (rf"(\bwhich(?:ever)? has more [^.]*)\. (?:check|start with|look at) (?:the )?(?:{names}) first\W*$", r"\1"),
        (
            rf"^(?:the )?([\w ]+?) (in|at|on) (?:the )?({names}), ((?:{_STATES}) or (?:{_STATES}))\?$",
            r"is the \1 \2 the \3 \4?",
        ),
        (rf"^(?:the )?({names}), ([\w ]+?) ((?:{_STATES}) or (?:{_STATES}))\?$", r"is the \2 at the \1 \3?"),
        (
            rf"^(\w+) count (at|in|on) (?=(?:the )?(?:{names})\b)",
            lambda match: f"count the {plural(match[1].lower())} {match[2]} ",
        ),
        (rf"\b(how many (?:(?!(?:are|is) )[\w ])+?) outside (?=(?:the )?(?:{names})\W*$)", r"\1 are at "),
        (rf"^(?:the )?({names}), now\W*$", r"go to the \1"),
        (rf"\bgo 2 (?=(?:the )?(?:{names})\b)", "go to "),
        (rf"^({_COUNTS} [\w ]+?)[,:] (?:the )?({names})\W*$", r"\1 at the \2"),
        (
            rf"^(\w+) count[,:]? (?:at )?(?:the )?({names}) (?:vs\.?|versus|v) (?:the )?({names})\W*$",
            lambda match: f"count the {plural(match[1])} at the {match[2]} and at the {match[3]}",
        ),
        (
            rf"^where(?:['’]?s| is| are) (?:there )?more ([\w ]+?),? (?:(?:down |over |up )?(?:at|in|on|near|by) )?"
            rf"(?:the )?({names}) "
            rf"or (?:(?:down |over |up )?(?:at|in|on|near|by) )?(?:the )?({names})\W*$",
            r"which has more \1, \2 or \3?",
        ),
        (
            rf"^(?:(?:two|three|four|\d) )(?:stills|photos|pictures|pics|shots|snaps): (?:the )?({names})(?:,| and|, then| then) "
            rf"(?:the )?({names})\W*$",
            r"take a picture at the \1 and at the \2",
        ),
        (
            rf"^(?:the )?((?:{names})(?: \w+)?) ((?:{_STATES})(?: or (?:{_STATES}))?(?: yet| still| now| again)?)\?",
            lambda match: f"{'are' if is_plural(match[1].split(' ')[-1]) else 'is'} the {match[1]} {match[2]}?",
        ),
        (
            rf"\b(?:throw|fling|chuck|stick|put|get|bring) (?:her|it|him|the camera) (?:over )?(?:on|onto|to|at) (?:the )?({names})"
            rf"(?: there)?\b",
            r"go to the \1",
        ),
        (
            rf"^(zoom in on|look at|find|follow|count|track) (?:the )?([\w ]+?), (?:at )?(?:the )?({names})\W*$",
            r"go to the \3, then \1 the \2",
        ),
        (
            rf"^(?:the )?({names})(?:,| -+| –|:) (?:the )?([\w ]+?) ({_STATES})\?+$",
            lambda match: _state_asked(match),
        ),
        (
            rf"\b((?:take|get|grab|make|snap) (?:me )?)(?:a|one) ({_PICTURES}) (?:at|of|from) (?:the )?({names}),? "
            rf"(?:and|then|and then|and afterwards) "
            rf"(?:another one|another|one|one more|a second(?: one)?) (?:at|of|from) (?:the )?({names})",
            r"\1a \2 at the \3 and at the \4",
        ),
        (
            rf"^([\w ]+?),? (?:at |in |on )?(?:the )?({names}) (?:vs\.?|versus|v|against) (?:the )?({names})(?:, (?:count both"
            rf"|how many|which has more|count))?\W*$",
            lambda match: (
                match[0] if NO_TOPIC.search(match[1]) else f"count the {match[1]} at the {match[2]} and at the {match[3]}"
            ),
        ),
        (
            rf"\bwhich (?:one )?of (?:the|these) (?:two )?(?:presets|places|views|positions|two),? (?:the )?({names}) "
            rf"(?:or|and) (?:the )?"
            rf"({names}),? (?:contains|has|shows|holds|have|has got) (?:the )?(more|most|fewer) ([\w ]+)",
            r"which has \3 \4, \1 or \2",
        ),
        (rf"^(?:the )?({names})[,:] ((?:{_STATES}) or (?:{_STATES}))\W*$", r"is the \1 \2?"),
        (rf"\blet['’]?s have the camera (?:on|at|over|over at) (?:the )?({names})(?: for \w+)?\b", r"go to the \1"),
        (
            rf"^.*\b(?:no|never mind|forget|sorry)\b.*\bit(?:['’]s| is| was) (?:the )?({names}) (?:that )?(?:i|we)"
            rf"(?:['’]m after| am after| wanted| want| meant| mean| need)\b.*$",
            r"go to the \1",
        ),
        (rf"^head ?count (?:on|of|for) (?:the )?([\w ]+?), (?:the )?({names})\W*$", r"count the \1 at the \2"),
        (
            rf"^(?:(?:go|proceed|move) to )?(?:the )?({names})(?:,| and)? then (?:the )?({names})[,.] *(?:(?:actually"
            rf"|no|wait|sorry)[, ]+)*"
            rf"(?:skip|forget|leave out|drop|disregard|cancel|ignore|not) (?:the )?({names})\W*$",
            lambda match: _visits_without(match),
        ),
        (
            rf"^(?P<news>.*?)\b(?:at|in|on|by|near|over by|over at|out at|outside|about) (?:the )?(?P<place>{names}),? "
            rf"(?:so |and )?(?:please |can you |could you |would you )*(?:(?:go|pop|head|nip|run|get) (?:over|down|up"
            rf"|across|out)? ?there"
            rf"|(?:show (?:me|us)|go to|bring up|take (?:me|us) to) (?:that one|it|there))\b",
            lambda match: match[0] if asks_for_something(match["news"], ()) else f"go to the {match['place']}",
        ),
        (
            rf"^(?:the )?({names}) ([a-z]+)(?:,|\.|:| -) ((?:{_STATES}) or (?:{_STATES}))\W*$",
            lambda match: f"{'are' if is_plural(match[2]) else 'is'} the {match[2]} at the {match[1]} {match[3]}?",
        ),
        (rf"\b(?:snap|take|grab|get) (?:me )?one of (?:the )?({names})\b", r"take a picture of the \1"),
        (rf"\bsee (?:the )?({names}) (?:car ?park|parking|area|place|side|bit)\b", r"see the \1"),
    ):
        text = re.sub(pattern, plain, text, flags=re.IGNORECASE)
    return text


def _state_asked(match: re.Match[str]) -> str:
    """Return "are the lights at the yard on?" for "yard - lights on?"; other texts are returned unchanged."""
    if NO_TOPIC.search(match[2]):
        return match[0]
    return f"{'are' if is_plural(match[2].split(' ')[-1]) else 'is'} the {match[2]} at the {match[1]} {match[3]}?"


def _visits_without(match: re.Match[str]) -> str:
    """Return "go to the yard" for "yard then gate. Actually skip the gate"."""
    kept = [name for name in match.group(1, 2) if name.lower() != match[3].lower()]
    return f"go to the {kept[0]}" if len(kept) == 1 else match[0]


def _without_apostrophes(text: str, presets: tuple[str, ...]) -> str:
    """Return a text with "kids pool" for "kids' pool" and "kid's pool", if a preset is named so."""
    for preset in presets:
        first, *rest = re.findall(r"[^\W_]+", preset) or [""]
        if rest and first.isalpha():
            stem = re.escape(first.lower().removesuffix("s"))
            text = re.sub(rf"\b{stem}(?:s['’]|['’]s)(?= {re.escape(' '.join(rest))}\b)", first, text, flags=re.IGNORECASE)
    return text

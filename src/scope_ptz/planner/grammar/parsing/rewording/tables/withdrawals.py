"""Patterns for parts of an instruction that are taken back, with what is left of the instruction."""

from __future__ import annotations

import re

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.rewording.withdrawn_parts import depends_on_part_before

_PICTURE = r"(?:pic|photo|picture|photograph|still|shot|snap|image)"
_PLEASE = r"(?:please |(?:can|could|will|would) you )*"
_NO = r"(?:(?:scratch that|actually|no|nah|nope|wait|sorry|oh)[, ]+)*"
_LEAVE_OUT = (
    r"(?:(?:i|we) (?:no longer|don['’]?t) (?:need|want)|no|scratch|skip|strike|omit|forget|cancel|nvm|cut"
    r"|leave|leave out|drop|scrap|never mind|don['’]?t (?:bother with|take))"
)

WITHDRAWALS = (
    (
        r"^(?:please )?(?:do not|don['’]?t) (?:recall|use|call(?: up)?|load|select|go to|visit) (?:any|an?)(?: of the)? presets?\b"
        r"(?:,? (?:and|but)|[,.;]) (?!.*\b(?:go|recall|visit|show|call|presets?|views?)\b)",
        "",
    ),
    (
        r"[,;.] (?:and |but )?(?:please )?(?:don['’]?t|do not) bother (?:with|about|counting) (?:the |a |an |any )?"
        r"(?!(?:pan|tilt|zoom|turn|mov)\w*)[\w ]{1,20}\W*$",
        "",
    ),
    (
        r"^(?:i['’]ll|i will) (?:do|pan|tilt|zoom|handle|move|swing|turn)\b[^,.;]*[,.;] (?:you )?(?=(?:just |please )?(?:count"
        r"|pan|tilt|zoom|take|go|tell)\b)",
        "",
    ),
    (r"^leave the (?:pan|tilt|zoom)(?:ning|ting|ing)? to me(?: and|,) ", ""),
    (r"^forget (?:about )?(?:the )?(?:panning|tilting|zooming|zoom|pan|tilt), ", ""),
    (r"\bwhat am i saying\b", "i mean"),
    (r"\b(?:on no account|under no circumstances|at no time|by no means) (?=\w)", "do not "),
    (r"\bactually,? no,? (?:leave|skip|drop|scrap) (?:that|it)(?=[,.;])", "actually no, forget that"),
    (r"\b(do not|don['’]?t) (?:on any account|under any circumstances|for any reason) ", r"\1 "),
    (r"\b(?:do not|don['’]?t) move anything\b", "don't move"),
    (r"\b(?:nobody|no one) (?:is to|may|must|should) (?=(?:touch|change|alter|use) (?:the )?(?:zoom|pan|tilt)\b)", "do not "),
    (r"\b((?:do not|don['’]?t) zoom)(?: in)?,? (?:and |but |just )?leave (?:it|the (?:view|shot|picture)) wide\b", r"\1"),
    (
        r"[.;,] the (photograph|photo|picture|pan|tilt|zoom|count) (?:is|are) (?:not|no longer) (?:necessary|needed"
        r"|required)(?: after all| any more)?\W*$",
        r". No, skip the \1.",
    ),
    (r"(?<=\w) (?=(?:scratch that|no wait|actually no)\b)", ", "),
    (r"\b(scratch that|no wait|actually no) (?=\w)", r"\1, "),
    (r"\b(?:no )?i tell a lie,? ", "sorry, "),
    (r",? (?:and )?(?:don['’]?t|do not) move (?:after|afterwards|after that)\W*$", ""),
    (r",? but (?:please )?(?:do not|don['’]?t) (?:photograph|film|record) (?:anybody|anyone|people|them)\W*$", ""),
    (r",? don['’]?t (?:follow|track|zoom in on) (?:nobody|no one|anybody|anyone)\W*$", ""),
    (
        r"[;,]? (?:and |but )?(?:please )?(?:you must not|do not|don['’]?t) zoom in on (?:anyone|anybody|anything"
        r"|people)\b[^.;]*\W*$",
        " without zooming",
    ),
    (r"[;,.] (?:do not|don['’]?t) (?:change|touch|alter) (?:the )?(?:pan|tilt|zoom) (?:or|and) (?:the )?(?:pan|tilt|zoom)\W*$", ""),
    (r",? (?:and |but )?(?:don['’]?t|do not) go zoomin['’g]* in on (?:anybody|anyone|anything|them|it)\W*$", " without zooming"),
    (
        r"^[^,.;]+[,.]+ *(?:(?:actually|oh) )*(?:nvm|never ?mind|(?:actually )?no,? don['’]?t bother)\b[, ]*"
        r"(?:don['’]?t|do not)?[, ]*(?=just\b)",
        "",
    ),
    (
        rf"^(?:take|get|grab|make|snap) (?:a |the |one )?{_PICTURE}\b[,.]* +{_NO}{_LEAVE_OUT} (?:the |that "
        rf")?{_PICTURE}[,.]+ *(?:just|only) "
        r"(?=\w)",
        "",
    ),
    (
        r" and (follow|track|count|read) (?:it|him|her|them)\b[.,;]+ *(?:(?:actually|no|wait|sorry|oh)[, ]+)*(?:do "
        r"not|don['’]?t) \1 "
        r"(?:it|him|her|them)\b",
        "",
    ),
    (
        r"[;,.] *(?:zooming in|panning|the zoom|the pan|that|this|the picture|the count) (?:is|will be) (?:enough|fine|plenty)\W*$",
        "",
    ),
    (
        r"(?<=, )(?:(?:actually|no|nah|wait|oh)[, ]+)+(?:leave (?:it|that|him|her|them)|never mind(?: that)?|forget "
        r"(?:it|that)),? +"
        r"(?=(?:just|only) \w)",
        "scratch that, ",
    ),
    (
        rf"^{_PLEASE}(?:follow|track|zoom in on|find|count|look at) [^,.]+[,.] *"
        rf"(?:(?:oh|no|actually|wait|sorry)[, ]+)*(?:never ?mind|forget)"
        r"(?: about)? (?:him|her|it|them|that)[,.] *(?:[^,.]+, )?(?:just |instead )?(?=(?:go|take|count|zoom|pan|tilt|home)\b)",
        "",
    ),
    (
        r"^count (the [\w]+)(?: (?:on|in|at|by|near) [\w ]+)?[,.] *(?:(?:actually|no|nah|wait|sorry)[, ]+)*(?:forget"
        r"|never ?mind) \1, "
        r"(?=count\b)",
        "",
    ),
    (
        r" and (?:then )?(follow|track|count|read|zoom in on) (?:it|him|her|them)\b[,.;]? *(?:(?:actually|no|wait|sorry|oh)[, ]+)+"
        r"(?:never ?mind|forget|skip|leave out|leave) (?:about )?the \1(?:ing|ning)? (?:part|bit)\W*$",
        "",
    ),
    (
        r"[,;]? (?:with|while|keeping|leaving) (?:the )?(?:pan|tilt|zoom)(?:,? and (?:the )?(?:pan|tilt|zoom))? "
        r"(?:left |kept |staying )?"
        r"(?:as (?:they are|it is)|unchanged|untouched|alone|where (?:they are|it is))\W*$",
        "",
    ),
    (
        r"^((?:.*?)(?:1[.)] )?(?P<a>[^.;]+?)[.;] 2[.)] (?P<b>[^.;]+?)(?:[.;] 3[.)] (?P<c>[^.;]+?))?)[.;] *"
        r"(?:correction[:,]? |actually,? )?"
        r"(?:skip|omit|leave out|drop|ignore|forget) step (?P<n>[123])\W*$",
        lambda match: _without_step(match),
    ),
    (
        r"^[^,.;]+[.,;] (?:actually|no|wait|on second thoughts?)[, ]+leave it (?:where|as|how) it (?:is|was)(?:,| and"
        r"|;)? (?:just |only )?"
        r"(?=\w+ )",
        "",
    ),
    (r"\b(\w+), (?:sorry|no|wait),? not \1, (?:but )?(?=\w)", ""),
    (r", or rather,? (?=(?:pan|tilt|zoom|turn|go|take)\b)", ", scratch that, "),
    (r"\b(count (?:the )?\w+), not the \w+\W*$", r"\1"),
    (r", no (?:picture|photo)s?(?: this time| please| needed| yet)?(?=,)", ""),
    (r"^neither pan nor tilt[,;] (?:only|just) ", ""),
    (
        r" and (?:then )?(?:follow|track|count|read|zoom in on) (?:it|him|her|them)\b[,.;]* *(?:(?:actually|no|wait"
        r"|sorry|oh)[, ]+)+"
        r"(?:don['’]?t|do not) (?:bother|worry about) \w+ing (?:it|him|her|them), (?:just )?(?=\w)",
        ", ",
    ),
    (
        rf"^{_PLEASE}(?:follow|track|zoom in on|find|count|look at) [^,.]+[,.] *"
        rf"(?:(?:nah|no|actually|oh)[, ]+)+(?:nvm|never ?mind)[, ]+"
        r"(?=(?:follow|track|zoom|find|count|go|take|pan|tilt)\b)",
        "",
    ),
    (
        r"^i (?:had meant|was going|meant|wanted) to ask (?:you )?(?:for|to)\b[^,;]*, but (?:please )?(?:don['’]?t|do "
        r"not) (?:trouble|bother)"
        r" (?:with|about) (?:that|it)(?: now)?[;,.] (?:simply |just )?",
        "",
    ),
    (r",? but (?:do not|don['’]?t) (?:follow|track) (?:it|him|her|them)(?: when [^.;]*)?\W*$", ""),
    (r",? no need to (?:zoom in on|follow|track|photograph|film) (?:anybody|anyone|anything|it|them|him|her)\W*$", ""),
    (
        r"^[^.;]+[.;] (?:(?:actually|no|wait|sorry)[, ]+)+forget it,? [^.;,]+[.;,] (?:just |only )?(?=(?:go|take|count"
        r"|zoom|pan|tilt|home)\b)",
        "",
    ),
    (
        rf"^{_PLEASE}(?:follow|track|zoom in on|find|look at) [^,.]+[,.]+ *"
        rf"(?:(?:no|actually|wait|oh)[, ]+)*(?:cancel that,? [^,.]+,"
        r"|leave (?:him|her|it|them) be(?: and|,)) (?:just )?(?=(?:find|follow|track|zoom|go|take|count|look)\b)",
        "",
    ),
    (r"[,;]? (?:and|but) (?:do not|don['’]?t) (?:follow|track) (?:anybody|anyone|anything)\W*$", ""),
    (
        r"[,.;]? (?:but |and )?(?:please )?(?:do not|don['’]?t) move the camera while (?:doing|you do) "
        r"(?:it|so|that)(?=\W*$|[,.;])",
        " without moving the camera",
    ),
)
"""Patterns with the words that replace them."""


def _without_step(match: re.Match[str]) -> str:
    """Return the steps of a numbered list without the one that is taken back."""
    steps = [match["a"], match["b"], match["c"]]
    return ", then ".join(step for i, step in enumerate(steps, 1) if step and i != int(match["n"]))


_TAKING = rf"(?:take|get|grab|make|snap)\b.*\b{_PICTURE}\b|(?:photograph|{_PICTURE})\b"
_PARTS = {
    "pan": r"(?:pan|panning)\b",
    "tilt": r"(?:tilt|tilting|tip)\b",
    "zoom": r"(?:zoom|zooming)\b",
    "picture": _TAKING,
    "count": r"count\b",
    "follow": r"follow\b",
    "home": r"(?:go|return|come) (?:back )?home\b",
    "going home": r"(?:go|return|come) (?:back )?home\b",
    "track": r"(?:track|follow)\b",
}
"""Patterns for the beginning of the parts of an instruction, by what may be left out of it."""

_LEFT_OUT = re.compile(
    rf"(?P<said>.+?)(?:[,.;]+| -+| –) *(?:(?:well|please|correction|scratch that|actual+y|no|nah|naw|nope|wait|sorry"
    rf"|oh|hang on|on second "
    rf"thoughts?)[,: ]+)*{_LEAVE_OUT} (?:the |that )?"
    rf"(?P<what>pan|tilt|zoom|count|follow|track|home|going home|{_PICTURE})(?:ning|ting|ing)?(?:,? (?:just|only) "
    rf"(?P<only>(?:do )?the \w+|go there|go home|do that|count|look))?\W*",
    re.IGNORECASE,
)


def without_part_left_out(text: str) -> str:
    """Return "go home" for "go home and take a photo, actually no, leave the photo"; other texts are unchanged."""
    if (match := _LEFT_OUT.fullmatch(text.strip())) is None:
        return text
    what = match["what"].lower()
    pattern = re.compile(_PARTS.get(what, _PARTS["picture"]), re.IGNORECASE)
    first, *rest = re.split(r"(,? and then |,? then |,? and? |, |[.;] )", match["said"])
    parts = [("", first), *zip(rest[::2], rest[1::2], strict=True)]  # each with the link before it
    kept = [(link, part) for link, part in parts if not pattern.match(part.strip())]
    if not kept or len(kept) != len(parts) - 1:
        return text
    dropped = next(i for i, (_, part) in enumerate(parts) if pattern.match(part.strip()))
    if any(depends_on_part_before(lexemes_of(part)) for _, part in parts[dropped + 1 :]):
        return text  # "pan left 20, tilt up 5, undo, forget the tilt"
    only = re.sub(r"^(?:do )?the |^(?:go there|do that)$", "", (match["only"] or "").lower())
    if not any(only in part.lower() for _, part in kept):
        return text  # "pan left 20 and tilt up 10, no, forget the tilt, just go home": what remains is unclear
    return kept[0][1] + "".join(link + part for link, part in kept[1:])

"""Recognise statements and comments that accompany a command without commanding anything."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scope_ptz.english.grammar.parts_of_speech import parts_of_speech, verb_form
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match

_PRONOUNS = frozenset({
    "i", "we", "they", "he", "she", "it", "this", "that", "these", "those", "there", "someone", "somebody", "something", "everyone",
    "everybody", "everything", "nobody", "no_one", "nothing", "you",
})  # fmt: skip
_PLURAL_PRONOUNS = frozenset({"i", "we", "they", "you", "these", "those"})
_MAX_SUBJECT = 7  # maximum number of words of a subject
_COMMANDS = (*VERBS, "HOME", "PRESET")
_ONLY_PAST = frozenset({
    "came", "went", "saw", "took", "fell", "broke", "began", "blew", "drove", "flew", "grew", "rang", "ran", "spoke", "wore",
    "gave", "ate", "froze", "stole", "threw", "woke", "rode", "swam", "forgot", "knew", "shook",
})  # fmt: skip
"""Past forms that are not participles, so they follow a subject: "the shouting came from behind", unlike "the car parked here"."""
_INTRANSITIVE_PAST = frozenset({
    "shouted", "yelled", "screamed", "coughed", "sneezed", "laughed", "giggled", "smiled", "waved", "nodded", "winked", "knocked",
    "complained", "moaned", "grumbled", "phoned", "asked", "wondered", "insisted", "barked", "honked", "hooted", "beeped", "buzzed",
    "whistled", "fainted", "collapsed", "slipped", "tripped", "stumbled", "arrived", "departed", "vanished", "disappeared",
    "appeared", "happened", "whispered", "apologised", "apologized", "replied", "swore", "radioed", "emailed", "texted", "panicked",
})  # fmt: skip
"""Past forms of verbs without an object, and of verbs of speaking, which are no participles after a noun: "my boss asked"."""
_REPORTING = frozenset({
    "say", "says", "said", "think", "thinks", "thought", "reckon", "reckons", "reckoned", "swear", "swears", "swore", "insist",
    "insists", "suspect", "suspects", "believe", "believes",
})  # fmt: skip
"""Verbs that are followed by what somebody says or thinks: "contractors say they put out twelve", "the forecast said rain"."""
_ACTIVITIES = frozenset({
    "got", "getting", "hearing", "missing", "losing", "having", "expecting",
})  # fmt: skip
"""Verb forms that are never commands to a camera: "..., getting glare off the water"."""
_PARTS = frozenset({"side", "hand", "lane", "edge", "end", "corner", "bank", "wing", "wall", "half"})


def is_statement(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes begin with a subject and a finite verb: "the sun is in the lens", "something just banged"."""
    first = 0
    while (
        first < len(lexemes) and lexemes[first].has("FILLER", "FIRSTLY", "COMMA", "BUT", "AND") and not _is_pronoun(lexemes[first])
    ):
        first += 1
    if first < len(lexemes) and lexemes[first].has("PREP") and not lexemes[first].has("DET"):
        return False
    return any(_is_predicate(lexemes[first:], end) for end in _subject_ends(lexemes[first:]))


def subject_of(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return the subject of a statement: "a kid" in "a kid just fell over"; empty if lexemes are not a statement."""
    for end in _subject_ends(lexemes):
        if _is_predicate(lexemes, end):
            return tuple(lexemes[:end])
    return ()


def without_future_time(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Strip a future time such as "in five minutes" from the end of lexemes: "we start loading in five minutes"."""
    match = full_match("(?P<body>_+) in (AMOUNTISH|DET)* (NUM|FRACTION|DET)+ (MINUTES|HOURS) (FILLER)*", lexemes)
    return tuple(match["body"]) if match else tuple(lexemes)


def is_past_event(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes only say what somebody did: "someone rang", unlike "someone is there" and "someone trapped"."""
    verb = next((x for x in lexemes[1:] if not _is_adverb(x)), None)
    return verb is not None and _is_only_past(verb) and is_statement(lexemes)


def is_comment(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are a comment without a subject: "lost my bearings", "far too close", "can't see it"."""
    words = [x for x in lexemes if not x.has("FILLER", "COMMA")]
    if not words:
        return False
    if full_match("(MODAL|DOV) not (SEE|READ|FREE) _*|(do)? NEGATED (FREE) _*|no FREE|not FREE", words):
        return not words[1].has("FREE") or verb_form(words[-1].word if len(words) < 3 else words[2].word) in {"base", None}
    asks = len(words) > 1 and words[1].word in {"any", "many", "much", "enough"}  # "got any vans"
    if words[0].word in _ACTIVITIES and len(words) > 1 and not asks and not any(x.has("NUM", "HOME", "PRESET") for x in words):
        return not any(x.has(*VERBS) for x in words[1:])
    if any(x.has(*_COMMANDS) for x in words):
        return False
    if words[0].word == "hope" and len(words) > 2 and words[1].has("SELF", "DET"):
        return True  # "hope you slept better than me"
    if words[0].has("FREE") and verb_form(words[0].word) in {"participle", "past"}:
        # "lost my bearings", unlike "charging points"
        return not (len(words) > 1 and not words[1].has("SELF", "DET") and is_only_noun(words[1]))
    degrees = [x for x in words if x.word in {"too", "far", "way", "so", "very", "much", "a_bit", "not"}]
    return words[0] in degrees and len(degrees) < len(words) and any(x.word in {"too", "so", "very"} for x in degrees)


def is_event(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether the words after "before" state an event, not a command: "I forget", "the ferry leaves"."""
    if full_match("SELF (CARRY|SWITCH|KEEP|HALT|leave|finish|close) (on|off|along|up|down|live|on_air)? (FILLER)*", lexemes):
        return True  # "we move on"
    if any(x.has(*_COMMANDS, "NUM", "DEG") for x in lexemes):
        return False
    ends_in_verb = len(lexemes) > 1 and _is_noun(lexemes[-2]) and verb_form(lexemes[-1].word) == "third person"
    return ends_in_verb or is_statement(lexemes)


def _subject_ends(lexemes: Sequence[Lexeme]) -> Iterator[int]:
    """Yield each number of lexemes that can form the subject at the beginning of a clause."""
    if lexemes and _is_pronoun(lexemes[0]):
        yield 1
    for end, lexeme in enumerate(lexemes[:_MAX_SUBJECT], 1):
        has_is = end < len(lexemes) and lexemes[end].word == "'s" and (end > 1 or _is_only_adjective(lexemes[end + 1 :]))
        if has_is and "NOUN" in parts_of_speech(lexeme.word):
            yield end  # "the stock check's at noon"
            return
        is_part = lexeme.word in {"left", "right"} and end < len(lexemes) and lexemes[end].word in _PARTS
        is_gerund = end == 2 and lexemes[0].has("DET") and lexeme.word.endswith("ing")
        is_share = end == 1 and lexeme.has("FRACTION") and len(lexemes) > 1 and lexemes[1].has("DET")
        is_function = lexeme.has("DET", "PREP", "NUM", "ORDINAL", "EVERY", "ANY", "CAMERA") or _is_possessive(lexeme)
        if not (_is_nominal(lexeme) or is_function or is_part or is_share or is_gerund or (lexeme.word in _PARTS and end > 1)):
            return
        if _is_noun(lexeme) or is_gerund or (lexeme.word in _PARTS and end > 1):
            yield end


def _is_only_adjective(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether lexemes are only a predicate: "(dust's) thick", "(shift's) nearly over", unlike "(dust's) edge"."""
    while len(lexemes) > 1 and parts_of_speech(lexemes[0].word) == {"ADV"}:
        lexemes = lexemes[1:]
    if len(lexemes) == 1 and lexemes[0].word in {"over", "done", "finished"}:
        return True
    return len(lexemes) == 1 and lexemes[0].has("FREE") and "ADJ" in parts_of_speech(lexemes[0].word)


def _is_predicate(lexemes: Sequence[Lexeme], start: int) -> bool:
    """Return whether a finite verb follows the subject, which ends before ``start``."""
    verb = start
    while verb < len(lexemes) and _is_adverb(lexemes[verb]):
        verb += 1
    if verb >= len(lexemes):
        return False
    lexeme, subject = lexemes[verb], lexemes[start - 1]
    if lexeme.word == "'s":
        return verb + 1 >= len(lexemes) or not is_only_noun(lexemes[verb + 1])  # "the sun's low", unlike "the chemist's shop"
    if lexeme.has("BE", "HAVEV", "DOV") and lexeme.word not in {"be", "been", "being", "having", "become"}:
        return True
    if lexeme.has("MODAL"):
        return True
    after = lexemes[verb + 1] if verb + 1 < len(lexemes) else None
    form = verb_form(lexeme.word)
    if _is_only_past(lexeme):
        return True
    if start == 1 and _is_pronoun(subject):
        return (form == "base" and subject.word in _PLURAL_PRONOUNS and subject.word != "you") or form in {"third person", "past"}
    if lexeme.word in _REPORTING and after is not None and (lexeme.word == "said" or after.has("DET", "PRON", "SELF", "SOMEONE")):
        return form != "base" or subject.word.endswith("s")
    if form == "third person":
        is_only_verb = "NOUN" not in parts_of_speech(lexeme.word)
        is_followed = after is not None and (after.has("DET", "PRON", "SELF") or after.word == "to")
        return is_only_verb or is_followed or (after is not None and verb_form(after.word) == "participle")
    if form == "past" and after is None and _is_possessive(lexemes[0]):
        return True  # "our manager queried"
    if (
        form == "base"
        and subject.word.endswith("s")
        and (lexemes[0].has("DET") or _is_possessive(lexemes[0]))
        and not lexeme.has(*VERBS)
    ):
        return after is not None and after.has("DET", "PRON", "SELF", "ANOTHER")  # "my grandkids love that"
    return form == "past" and after is not None and after.has("DET", "PRON", "SELF", "SOMEONE")


def _is_only_past(lexeme: Lexeme) -> bool:
    return lexeme.word.split("_")[0] in _ONLY_PAST or lexeme.word in _INTRANSITIVE_PAST


def _is_adverb(lexeme: Lexeme) -> bool:
    if lexeme.has("BE", "HAVEV", "MODAL", "DOV") or verb_form(lexeme.word) in {"third person", "past"}:
        return False
    known = parts_of_speech(lexeme.word)
    if lexeme.has("FILLER") and "VERB" in known and "ADV" not in known:
        return False  # "my children love it"
    return lexeme.has("ADVERB", "FILLER") or known == {"ADV"}


def _is_pronoun(lexeme: Lexeme) -> bool:
    return lexeme.word in _PRONOUNS


def _is_possessive(lexeme: Lexeme) -> bool:
    return lexeme.word in {"my", "our", "your", "his", "her", "their", "its"}


def _is_nominal(lexeme: Lexeme) -> bool:
    """Return whether a lexeme can be part of a noun phrase: a noun, an adjective or an unknown word."""
    if lexeme.word == "'s" or not lexeme.has("FREE", "ADVERB", "CAMERA", "PICTURE", "VIEWNOUN", "GLUE"):
        return False
    known = parts_of_speech(lexeme.word)
    if not known:
        return lexeme.has("FREE")
    return bool(known & {"NOUN", "ADJ", "ADV", "PROPN"}) or verb_form(lexeme.word) == "past"


def is_only_noun(lexeme: Lexeme) -> bool:
    """Return whether a word is a noun and neither an adjective nor an adverb."""
    known = parts_of_speech(lexeme.word)
    return "NOUN" in known and not known & {"ADJ", "ADV"} and verb_form(lexeme.word) not in {"participle", "past"}


def _is_noun(lexeme: Lexeme) -> bool:
    if lexeme.has("CAMERA", "PICTURE", "VIEWNOUN"):
        return True
    known = parts_of_speech(lexeme.word)
    return lexeme.has("FREE") and lexeme.word != "'s" and (not known or "NOUN" in known or "PROPN" in known)

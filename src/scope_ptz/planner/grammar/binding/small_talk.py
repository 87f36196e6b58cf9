"""Reply to what needs no camera: thanks, greetings, "stop", and requests that no camera can carry out."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.courtesy import bare_clause
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

_THANKS = frozenset({
    "thank", "thanks", "thankyou", "thx", "tx", "ty", "cheers", "ta", "appreciated", "merci", "danke", "gracias", "grazie", "takk",
})  # fmt: skip
_FAREWELLS = frozenset({
    "goodbye", "bye", "bye_bye", "cheerio", "good_night", "see_you", "see_ya", "see_you_later", "catch_you_later", "talk_later",
})  # fmt: skip
_GREETINGS = frozenset({
    "hello", "hello_there", "hi", "hi_there", "hey", "hey_there", "hiya", "howdy", "g'day", "good_morning", "morning",
    "good_afternoon", "afternoon", "good_evening", "evening",
})  # fmt: skip
_PRAISE = frozenset({
    "great", "perfect", "excellent", "lovely", "brilliant", "nice", "nice_one", "cool", "well_done", "good_job", "job_done",
    "spot_on", "bang_on", "much_better", "that_is_great", "that_is_perfect", "that_is_fine", "that_is_better", "that_is_it",
    "that_will_do", "that_will_do_nicely",
})  # fmt: skip

_ADMIRED = "great|good|nice|perfect|excellent|lovely|brilliant|fantastic|amazing|wonderful|superb|impressive|awesome|cool"
_DEED = "job|work|stuff|effort|camera|shot|picture|view"
_PRAISING = (
    f"(FILLER)* (you|that|this|it) (BE|was|were|HAVEV|DOV|did|been|doing|done|working)+ (DET|very|so|really|most|FILLER|ADVERB)* "
    f"({_ADMIRED}|well|well_done|spot_on|star|legend|gem|genius|clever|smart|wonders) ({_DEED}|FILLER)*"
    f"|(FILLER)* (what|WHQ) (DET|very|really)* ({_ADMIRED}) ({_DEED}) (FILLER)*"
    f"|(FILLER|DET|very|really)* ({_ADMIRED}) (job|work|stuff|effort) (FILLER)*"
    f"|(FILLER)* (that_is_great|that_is_perfect) ({_DEED}) (FILLER)*"
)
"""Praise: "you are doing great", "that was brilliant", "what a great job". "A good picture" asks for one."""

_WELLBEING = (
    "(FILLER|AND)* how (BE|DOV|do) (SELF|you|things|everything|life) (doing|do|DOACT|CARRY-ING|today|feeling|FILLER)*"
    "|(FILLER|AND)* how (BE|'s) it going (today|FILLER)*"
    "|(FILLER|AND)* how BE SELF (day|shift|morning|afternoon|evening) (CARRY-ING|so|far|FILLER)*"
)
"""Polite questions about how somebody is: "how are you?", "how's it going?"."""

_REFUSING = "(FILLER|BUT|but|no|nope|nah)*"
_REJECTING = (
    f"{_REFUSING} ((that|this|it) BE)? (DET)? wrong (one|FREE)"
    f"|{_REFUSING} (that|this|it) BE not (it|DET one|DET right (one|FREE)|what SELF (meant|mean|said|asked|wanted|want) (for)?)"
    f"|{_REFUSING} not (that|this) (one|FREE)"
)
"""Words with which somebody rejects what was taken and does not say what is meant: "that is the wrong one"."""

_RADIO_CHECK = "(FILLER|COMMA|DASH|CAMERA)* (radio|comms|mic|sound) check (over|FILLER|COMMA|STOP|QUESTION)*"

_RECEIVING = "Receiving you. Tell me where to look, or ask what is in view."
_WHO_ARE_YOU = "(FILLER|AND|COMMA)* (who|what) BE (you|SELF) (exactly|actually|FILLER)* (STOP|QUESTION)*"
_INTRODUCTION = 'I steer the camera and answer questions about what it sees, such as "how many people are there?".'
_WELCOME = "You're welcome."
_THANK_YOU = "Thank you. Tell me when you want to see something else."
_WELL = 'I am well, thank you. Tell me where to look, or ask what is in view, for example: "how many people are there?".'
_GOODBYE = "Goodbye."
_ALL_RIGHT = "All right. Tell me when you want to see something else."
_NOT_MOVING = "I am not moving. The camera stays where it is."
_HELLO = 'Hello. Tell me where to look, or ask what is in view, for example: "how many people are there?" or "zoom in on the sign".'

_MOVING = "AIM-ING|PAN-ING|TILT-ING|ZOOM-ING|TURN-ING|CARRY-ING"
_HALT = (
    f"(FILLER|LEADFILLER|COMMA)* (HALT|stop_moving) (HALT|there|here|now|everything|{_MOVING}|DET CAMERA|CAMERA|FILLER|COMMA|STOP)*"
)
_THANKS_FOR = "(FILLER)+ for ((?!AND|THEN|NUM|LEFT|RIGHT|UP|DOWN|IN|OUT)_){1,4}"
_CLOSING = (
    "(FILLER)* (that|this) (BE|MODAL be) all (FILLER|SELF (need|want|wanted|needed)|for (now|today|tonight))*"
    "|(FILLER)* (that|this|it) (BE|was) (very|so|most|FILLER|ADVERB)* (helpful|useful|handy|kind|enough) (FILLER)*"
)
_NO_THANKS = "(no|nope|nah) (FILLER)*"


def reply_to_small_talk(instruction: str) -> str:
    """Return the reply to thanks, a greeting, or "stop" on its own; empty for a text that asks for anything."""
    lexemes = lexemes_of(instruction)
    if full_match(_HALT, lexemes):
        return _NOT_MOVING
    if full_match(_RADIO_CHECK, lexemes):
        return _RECEIVING
    if full_match(_WHO_ARE_YOU, lexemes) and any(x.word == "you" for x in lexemes):
        return _INTRODUCTION
    sentences = _split(lexemes)
    if len(sentences) > 1 and full_match(_NO_THANKS, sentences[0]):  # "no thanks, that's all"
        sentences = [*sentences[1:], [x for x in sentences[0] if x.has("FILLER")]]
    if not sentences or not all(_is_small_talk(sentence) for sentence in sentences):
        return ""
    words = {x.word for x in lexemes}
    if any(_has_thanks(sentence) for sentence in sentences):
        return _GOODBYE if words & _FAREWELLS else _WELCOME
    if any(full_match(_CLOSING, sentence) for sentence in sentences):
        return _ALL_RIGHT
    if any(full_match(_WELLBEING, sentence) for sentence in sentences):
        return _WELL
    if words & _FAREWELLS:
        return _GOODBYE
    if words & _GREETINGS:
        return _HELLO
    if any(full_match(_PRAISING, sentence) for sentence in sentences):
        return _THANK_YOU
    return _ALL_RIGHT if words & _PRAISE else ""


def question_about_rejection(instruction: str) -> str:
    """Return the question which one is meant, after "that is the wrong one"; empty for other texts."""
    lexemes = [x for x in lexemes_of(instruction) if not x.has("STOP", "COMMA", "DASH")]
    return "Which one do you mean? Please describe it." if lexemes and full_match(_REJECTING, lexemes) else ""


def _split(lexemes: Sequence[Lexeme]) -> list[Sequence[Lexeme]]:
    """Split lexemes at punctuation."""
    sentences: list[list[Lexeme]] = [[]]
    for lexeme in lexemes:
        if lexeme.has("COMMA", "STOP", "DASH", "QUESTION"):
            sentences.append([])
        else:
            sentences[-1].append(lexeme)
    return [sentence for sentence in sentences if sentence]


def _is_small_talk(sentence: Sequence[Lexeme]) -> bool:
    return bool(
        all(x.has("FILLER", "LEADFILLER", "CAMERA") for x in sentence)
        or (_has_thanks(sentence) and full_match(_THANKS_FOR, sentence))
        or any(full_match(pattern, sentence) for pattern in (_CLOSING, _PRAISING, _WELLBEING))
    )


def _has_thanks(sentence: Sequence[Lexeme]) -> bool:
    return any(word in _THANKS for x in sentence if x.has("FILLER") for word in x.word.split("_"))


NEVER_MIND = "OK."
"""The reply to a user who no longer wants what was spoken of."""

_NEVER_MIND = "(FILLER|no|oh|actually|COMMA|STOP|DASH)* (never mind|nevermind|nvm|nm|forget (about)? it) (FILLER|THEN|COMMA|STOP)*"
_SAY_AGAIN = (
    "(FILLER|MODAL SELF|COMMA|STOP|DASH)* (say_again|(say|come) (that|it|this)? again|pardon|pardon_me|SELF beg your pardon|"
    "what DOV SELF (FILLER)* say|repeat (your|DET|last|that)* (answer|reply|message)) (FILLER|COMMA|STOP|QUESTION)*"
)


def dismisses(instruction: str) -> bool:
    """Return whether a text only says that nothing is wanted any more: "ok, never mind"."""
    return full_match(_NEVER_MIND, lexemes_of(instruction)) is not None


def asks_to_repeat_reply(instruction: str) -> bool:
    """Return whether a text asks for the last reply once more: "say again", "come again?", "what did you say?"."""
    return full_match(_SAY_AGAIN, lexemes_of(instruction)) is not None


_ASKED_BEFORE = (
    "(FILLER|COMMA)* what DOV SELF (just|FILLER)* (ask|TELL|want|request) (you|me|for|to do)* "
    "(?P<first>first|FIRSTLY|at first|first of all)? "
    "(last|before|earlier|just|now|NOW|BEFORE|FILLER|STOP|QUESTION)*"
)


def recalled_message(instruction: str, earlier: Sequence[str]) -> str:
    """Return the user's first or last message for "what did I ask first?"; empty for other texts.

    Args:
        instruction: The user's text.
        earlier: The user's earlier messages, oldest first.
    """
    lexemes = lexemes_of(instruction)
    match = full_match(_ASKED_BEFORE, lexemes)
    if match is None or not earlier or not any(x.word in {"i", "we"} for x in lexemes):
        return ""
    is_first = match.has("first")
    return f'Your {"first" if is_first else "last"} message was "{earlier[0 if is_first else -1].strip()}".'


_SWITCHING = "(switch|turn|put|flick|flip) (DET|FREE)* (on|off) (DET|FREE)*"
_SPEAKING = "(tell|inform|ask|order|remind|warn|instruct|call|phone|ring|radio|alert|notify|page) (DET)? (FREE)+ (_)*"
_HANDLING = (
    "(open|close|shut|lock|unlock|push|pull|lift|clean|wash|paint|repair|mend|fix|park|drive|water|feed|sell|buy|deliver|unload"
    "|remove|sweep|tidy|print|email|play|build|stop|start|move) (DET)+ (FREE)+ (_)*"
)
_CANNOT = (
    (_SWITCHING, "switch anything on or off"),
    (_SPEAKING, "talk to anyone"),
    (_HANDLING, "touch or operate what I see"),
)


def impossible_request(instruction: str) -> str:
    """Return why a request that was not understood cannot be carried out: "open the gate". Empty for other texts.

    It is called only if the text was not understood, so "turn on the spot" does not get here.
    """
    lexemes = bare_clause([x for x in lexemes_of(instruction) if not x.has("STOP", "QUESTION")])
    is_request = any(x.has("FREE") for x in lexemes)
    deed = next((deed for pattern, deed in _CANNOT if is_request and match_start(pattern, lexemes)), "")
    if not deed:
        return ""
    return f"I can only move the camera and answer questions about what it sees; I cannot {deed}. What shall I look at?"

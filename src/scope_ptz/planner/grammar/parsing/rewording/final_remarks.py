"""Take a remark off the end of the text of an instruction: a reason, news or a complaint, which asks for nothing."""

from __future__ import annotations

import re

from scope_ptz.english.grammar.numbers import NUMBER_WORDS

_OPINIONS = r"(?:think|thought|reckon|bet|guess|suspect|hope|believe|heard|swear|promised|told \w+)"
_SUBJECTS = (
    r"(?:i|we|he|she|they|it|someone|somebody|some \w+(?:'s)? ?\w*|(?:the|my|our|their|an?) \w+(?: \w+)?|one of (?:the|my|our) \w+)"
)
_BE_OR_HAVE = r"(?:'s|'re|'m|'ve|'d| is| are| am| was| were| has| have| had| will| never| always| keeps?| only| just| really)"
_SAID = (
    r"(?: (?:reckons?|says?|said|thinks?|rang|called|phoned|radioed|told|wants|wanted|keeps|lost|left|got|saw|heard|complained))"
)
_STATEMENT = re.compile(
    rf"(?:i'm sure |i am sure |honestly |apparently )?(?:{_SUBJECTS}(?:{_BE_OR_HAVE}|{_SAID}| {_OPINIONS} {_SUBJECTS})"
    r"|(?:he|she|they|it) \w+s? |(?:looks|seems|sounds|feels) like |boss is |i'm done"
    rf"|all i'm (?:getting|seeing) is|(?-i:[A-Z][a-z]+)(?:{_SAID}|'s| is| has)|(?-i:Driver|Boss|Gaffer|Foreman"
    rf"|Chief){_SAID}) ?\b[\w', -]*",
    re.IGNORECASE,
)
"""A statement by its subject and verb: "I'm sure we're two short today", "Dave reckons it's getting too high"."""

_ASKED = re.compile(
    r"^(?:it|that|this)\b.*\d|(?:\b(?:to the|pan|turn|go|look|bit|touch) left|\bleft (?:by|a bit|\d)|^left|left$)|\b"
    r"(?:right|(?<!playing )(?<!set )up(?! to\b)|down|out|higher|lower|zoom\w*|pan\w*|tilt\w*|turn\w*|rotat\w*"
    r"|swing\w*|point\w*|aim\w*|mov\w+|degrees?|home|presets?|times|"
    r"pictures?|photos?|snaps?|shots?|stills?|pics?|images?|count\w*|(?<!lost )track\w*|follow\w*|read\w*|find\w*"
    r"|check\w*|look\w*|see|seeing|"
    r"show\w*|tell|know|camera|view|closer|wider|stop\w*|cancel\w*|forget|scratch|scrap|leave|wrong|mistake|instead|actually|mean\w*|"
    r"rather|not|no|nobody|none|nothing|unless|if|but|until|when|while|whether|where|which|who|whose|how|what|then|or|"
    r"should|must|shall|supposed|allowed|ought|can|could|would|want|wants|wanted|need\w*|like|prefer\w*|only interested|interested|"
    r"error|thoughts|against|wait\w*|hold|off|asking|talking|ones|(?:the|that|this|which|red|other|next|last|big"
    r"|small) one|especially|particularly|except|apart|both|every|each|any|please|you|your|there's|there|forbidden|limits?|"
    r"banned|private|secret|please|joking|kidding|changed|decided|done|already)\b|n't\b",
    re.IGNORECASE,
)
"""Words with which a statement may ask for something, restrict what was asked, or take it back."""

_NUMBER = re.compile(rf"\d|\b(?:{'|'.join(sorted(word for word in NUMBER_WORDS if word.isalpha()))})\b", re.IGNORECASE)
_BOUNDARY = re.compile(r"(?:[,;.!?]| -+| –| —)\s+(?=[\w'’]+[^.;!?]*[.!]*$)")
_REASON = re.compile(r",? (?:as|because|'?cause|cos|coz|since) ", re.IGNORECASE)
_EVENT = re.compile(
    r" before (?:(?:the|my|our|his|her) \w+|\w+) (?:walks|comes|gets|turns|shows|leaves|goes|drives|pulls|arrives)"
    r"(?: (?:in|back|here|up|out|off|away|past|by))*\s*[.!]*$",
    re.IGNORECASE,
)
_IDIOMS = re.compile(
    r"(?:,|[.?]| -+) (?:(?:i )?(?:don't|do not) like the look of (?:him|her|them|it|that)|(?:he|she|they|someone)"
    r"(?:'s|'re| is| are) up to "
    r"(?:something|no good)|(?:i|we)(?:'ve| have) a bet on|i keep losing (?:track|count)|i swear(?: to god)?"
    r"|(?:my|me) eyes (?:aren't|are not|ain't) what they (?:used to be|were)|(?:he|she|they) never signed (?:out|in)"
    r"|(?:i|we)(?:'ve| have)? lost (?:track|count)|(?:the |my )?boss is askin(?:g)?|last time (?:i|we) couldn't see "
    r"(?:a thing|anything)"
    r"|it's been (?:that|one of those|a) (?:sort|kind|type)? ?(?:of )?\w+|there's one just \w+ in|do i need (?:my|me|a|an) \w+"
    r"|just wonderin(?:g)? (?:where|what|how|why) to [\w ]+|can (?:you|yer) count (?:them|em)|thanks a (?:million"
    r"|bunch|lot)|i only sent \w+ \w+)[.!]*$",
    re.IGNORECASE,
)
_NEWS_BEFORE_QUESTION = re.compile(
    r"(?P<news>[^?]+?)(?:, so|[.;]) (?P<question>(?:how many|is|are|what|which|has|have|any) [^.;]+\?*)", re.IGNORECASE
)
_PRONOUNS = re.compile(r"\b(?:it|its|they|their|them|him|his|her|he|she|that|those|these|this|there|ones?)\b", re.IGNORECASE)
_MIN_WORDS = 3
_MIN_NEWS = 6  # minimum number of words
_MAX_REMARKS = 3


def without_final_remark(text: str, presets: tuple[str, ...]) -> str:
    """Return a text without the remark at its end.

    A remark with a word for a command, a restriction or a withdrawal, or with the name of a preset, is kept, and so is one with a
    number after an instruction with a number: "pan left 20, Dave says thirty".
    """
    text = _without_news_ahead(text, presets)
    for _ in range(_MAX_REMARKS):
        shorter = _without_last(text, presets)
        if shorter == text:
            break
        text = shorter
    return text


def _without_last(text: str, presets: tuple[str, ...]) -> str:
    """Return a text without the last of its remarks."""
    if idiom := _IDIOMS.search(text.replace("’", "'")):
        return text[: idiom.start()] + ("?" if idiom[0].startswith("?") else "")
    text = _EVENT.sub("", text)
    for boundary in (*_BOUNDARY.finditer(text), *_REASON.finditer(text)):
        tail = text[boundary.end() :].strip().rstrip(".!")
        is_correction = _NUMBER.search(tail) is not None and _NUMBER.search(text[: boundary.start()]) is not None
        if boundary.start() and not is_correction and _is_remark(tail, presets):
            return text[: boundary.start()] + ("?" if boundary[0].startswith("?") else "")
    return text


def _without_news_ahead(text: str, presets: tuple[str, ...]) -> str:
    """Return "zoom in on the tile" for "one of the guests has complained, so zoom in on the tile".

    Before a question without pronouns, any words that ask for nothing are news.
    """
    if (asked := _NEWS_BEFORE_QUESTION.fullmatch(text)) is not None and not _PRONOUNS.search(asked["question"]):
        news = asked["news"].replace("’", "'")
        is_news = len(news.split()) >= _MIN_NEWS and not _ASKED.search(re.sub(r"\bthere(?='s)", "", news))
        if is_news and not _names_preset(news, presets):
            return asked["question"]
    news, link, rest = text.replace("’", "'").partition(", so ")
    return rest if link and len(rest.split()) >= _MIN_WORDS and _is_remark(news.strip(), presets) else text


def _is_remark(statement: str, presets: tuple[str, ...]) -> bool:
    is_long = len(statement.split()) >= _MIN_WORDS
    is_statement = is_long and _STATEMENT.fullmatch(statement.replace("’", "'")) is not None
    return is_statement and not _ASKED.search(statement.replace("’", "'")) and not _names_preset(statement, presets)


def _names_preset(text: str, presets: tuple[str, ...]) -> bool:
    words = set(re.findall(r"\w+", text.lower()))
    return any(words & set(re.findall(r"[^\W_]+", preset.lower())) for preset in presets)

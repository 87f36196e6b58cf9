"""Remove remarks that ask for nothing from the text of an instruction: reasons, news and complaints at its beginning or end."""

from __future__ import annotations

import re

from scope_ptz.english.grammar.numbers import NUMBER_WORDS
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.asides import may_withdraw
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.statements import is_statement

_REPORTING = "reckons?|says?|said|thinks?|rang|called|phoned|radioed|told|wants|wanted|keeps|lost|left|got|saw|heard|complained"
_STATEMENT = re.compile(
    r"(?:(?:i|someone|somebody|they|he|she) )?(?:left|lost|dropped|dumped) (?:it|them|my|the) .+"
    r"|(?:the|my|our) (?!camera)(?:\w+ ){0,2}\w+ left (?:it|them) (?:in|at|on|like) .+"
    r"|(?:had|used|seen|borrowed) (?:it|them|him|her|one) .+"
    r"|i(?:'ve| have) "
    r"(?:got )?to \w+ .+|(?:heard|saw|thought i (?:heard|saw)) .+|there(?:'s| is| are) .+|"
    r"(?:the |my |our |an? )?(?:\w+ ){1,5}wants? to know"
    r"|i (?:just )?want(?:ed)? to (?:see|check|make sure) (?:if|whether|that|how|what) .+"
    r"|(?:the |my )?(?:boss|gaffer|foreman|chief|manager|supervisor|client) wants .+|"
    rf"all (?:i'm|we're) (?:getting|seeing) is .+|all (?:i|we) (?:can see|see|get) is .+|can'?t (?:see|read|make out) "
    rf".+|(?:looks|seems|sounds|feels) .+|(?:boss|gaffer) is .+|i'm done.*|i "
    rf"(?:can't|cannot) remember if .+|(?:i'm|i am) trying to (?:establish|find out|work out|see) .+|(?:gotta|got to) .+"
    rf"|(?-i:[A-Z][a-z]+)(?: (?:{_REPORTING})|'s| is| has) .+|some \w+ \w+'s .+|(?:i|we|it) (?:\w+ )?wants .+|its "
    rf"(?:got|been|getting) .+"
    r"|(?:think|reckon|guess|suspect|bet|hope|fear|doubt|pretty sure|not sure|dunno) (?:it|its|it's|he|he's|she|she's|they|they're"
    r"|the|that|that's|there's|somebody|someone|my|our|if|whether)\b.*",
    re.IGNORECASE,
)
"""Statements that ``is_statement`` does not recognise: "Dave reckons it's getting too high", "looks funny from here"."""

_COMMAND = (
    r"zoom\w*|pan(?:s|ned|ning)?|tilt\w*|turn(?:s|ing)?|rotat(?:e|es|ing)|swing(?:s|ing)?|swivel\w*|point(?:ing)?|aim\w*|mov(?:e|ing)|degrees?|home|presets?"
    r"|snap\w*|count(?:s|ed|ing)?|(?<!lost )track(?:ing)?|follow\w*|(?<!to )read|find|check(?:s|ing)?|look(?:ing)? "
    r"(?:at|for|up|down"
    r"|left|right|in|over)"
    r"|show (?:me|us)|tell|cameras?|closer|wider|higher|lower|stop|go to|goto|take (?:a|the|one|another|some)|leave (?:it|that)"
    r"|pictures?|photos?|stills|(?:an?|the|one|more|another|nice|quick|clear|good|single) still"
    r"|shots?|images?|pics?|view|times|(?:look|see|have a look) (?:everywhere|anywhere)"
)
_DIRECTION = (
    r"(?:to the|on the|pan|turn|go|look|bit|touch|said|the) (?:left|right)|(?:left|right) (?:by|a bit|\d|side|one|hand)"
    r"|(?:go|look|further|bit|touch|said) (?:up|down|in|out)"
)
AT_AN_END = r"^(?:left(?! (?:it|them|him|her)\b)|right|up|down|in|out)\b|(?<!me )(?<!it )(?<!us )(?<!is )\b(?:left|right|up|down)$"
_RESTRICTION = (
    r"ones|(?:that|this|which|red|other|next|last|big|small|the) one|especially|particularly|except|apart from|both"
    r"|every|each|instead"
    r"|actually|rather|means?|meant(?! to)|(?:i|we)(?:'d| would)? (?:want|need|like|prefer)(?! to see)|interested"
    r"|after the|asking|talking"
    r"|not (?:the|to|that|this|there|here|in|on)|isn't (?:the|that|this)"
    r"|(?:a single|one) (?:\w+ )?(?:move|movement|motion|command|go|step)"
)
_REQUEST = (
    r"must(?! be \w+ed\b)|should(?! (?:be (?:in|here|back|due|along|ready|my|our|his|her|their|parked|standing"
    r"|(?:out|over|around) (?:there|here))"
    r"|have|(?:go|come|switch|turn|be) (?:off|on) (?:at|by|when))\b)"
    r"|shall|ought|you|your|please|(?<!see "
    r")(?<!remember )"
    r"(?<!wonder )if|unless|until"
    r"|(?:know|tell|check|find out|ask) (?:how|what|whether|which|where|who|if|when)"
)
WITHDRAWAL = (
    r"wrong|mistake|error|thoughts|against|hold on|cancel\w*|forget|scratch|scrap|never mind|nvm|kidding|joking"
    r"|changed|decided|limits?"
    r"|forbidden|allowed|banned|private|secret|called off|don't|do not|didn't want"
    r"|already(?! had (?:an?|one|two|three|his|her|their|some) [a-z]{3})"
    r"|refus\w+|abort\w*|retract\w*|revok\w+|disregard|belay|strike that|stays? put|objects?|objected|permission|approval"
    r"|(?:we|you|i) (?:should|must|need|ought)n't|not what (?:i|we)|told (?:you|me|us|him|her) (?:not |never )?to"
    r"|nobody (?:told|asked|said)|(?:he|she|they|i|we) meant|assuming|provided|providing|subject to|bad idea|typo|slipped"
    r"|imagine|pretend|suppose|supposing|hypothetical"
)
_ASKED = re.compile(
    rf"{AT_AN_END}|^(?:it|that|this)\b.*\d|\b(?:{_COMMAND}|{_DIRECTION}|{_RESTRICTION}|{_REQUEST}|{WITHDRAWAL})\b", re.IGNORECASE
)
"""Words with which a statement may ask for something, restrict what was asked, or take it back."""

_COMMANDING = re.compile(rf"\b(?:{_COMMAND}|{_DIRECTION})\b", re.IGNORECASE)
_HARMLESS = re.compile(
    r"\b(?:in|on) (?:my|the|our|this) (?:shot|view|picture|frame|way|screen)\b|\bset up\b|\bup to (?:something|no good)\b"
    r"|\b(?:under(?:neath)?|below|beneath|behind|above|near|beside) you\b"
    r"|\b(?:boss|manager|he|she|they|gaffer|foreman|everyone|somebody|someone)(?:['’]s| is| are|['’]re| was)? asking\W*$"
    r"|\b\w+ (?:is|are|was|were|keeps?) asking(?: me| us)?(?: about (?:it|them|this|that))?\W*$"
    r"|\b(?:i|we) (?:can['’]?t|cannot|could not|couldn['’]?t) (?:tell|make out|see|work out|read)"
    r"(?: from here)? (?:if|whether|what|which|who)\b"
    r"|\b(?:got|have|had) (?:\w+ ){1,4}asking (?:me |us )?about\b"
    r"|\b(?:wr[io]te|writing|written|not(?:e|ed|ing)|jott?(?:ed|ing)?) (?:it|them|that|this|those|any|all of (?:it|them)) down\b"
    r"|\b(?:pan|tilt|zoom) (?:smoothness|speed|accuracy|performance|response|motors?|gears?|mechanism|backlash)\b"
    r"|\b(?:its|his|her|their) (?:left|right)[- ](?:turn|arm|leg|foot|wheel|wing|side|flank|indicator|headlight)s?\b"
    r"|\bi (?:just )?want(?:ed)? the (?:whole )?(?:lot|thing|works)\b|\bunder the camera\b"
    r"|\b(?:won['’]?t|will not|doesn['’]?t|never) stop (?!pan|tilt|zoom|turn|mov|track|follow|point)\w+ing\b"
    r"|\bshould (?:arrive|turn up|come|land|be there)\b|\bshould be (?:bringing|coming|arriving|landing|starting"
    r"|finishing|done|ready)\b"
    r"|\b(?:i|we) (?:don't|do not) want to (?:miss|lose|be late|upset|wake|disturb)\b"
    r"|\b(?:i|we) (?:don't|do not|wouldn't) want (?:anyone|anybody|someone|somebody|people|him|her|them|the \w+) (?:to )?"
    r"(?:slip|fall|trip|get|driv|walk|complain|wait|run|bump)\w*"
    r"|\btrying to (?:see|work out|figure out|find out) (?:if|whether|what|which|how)\b"
    r"|\b(?:remember|recall|forgot|forget) (?:about )?\w+ing (?:it|them|that)\b"
    r"|\b(?:been|gone|come|came|went|passed|rung|rang|called|walked|driven|drove|tried) (?:\w+ ){0,2}(?:twice|three "
    r"times|four times|\w+ times)"
    r"|\b(?:asking|asked|talking|told me) about (?:the|this|our) (?:view|camera)\b"
    r"|\b(?:just |only )?(?:looking|pointing|staring) at (?:the )?(?:sky|ground|floor|ceiling|wall|clouds)\b",
    re.IGNORECASE,
)
"""Phrases with such words that nevertheless ask for nothing: "somebody in our shot", "the boss is asking"."""

NUMBER = re.compile(rf"\d|\b(?:{'|'.join(sorted(word for word in NUMBER_WORDS if word.isalpha()))})\b", re.IGNORECASE)
AMOUNT = re.compile(
    rf"(?:{NUMBER.pattern})(?=\W*$|\W* ?(?:degrees?|deg|x|times|percent|%|seconds?|secs?|minutes?|mins?|left|right|up"
    rf"|down|to|instead))",
    re.IGNORECASE,
)
"""A number that may be the amount of a move, unlike the one in "there are 25 people waiting"."""

_BOUNDARY = re.compile(r"(?:[,;.!?]|(?<=\w) -+| –| —)\s+(?=[\w'’]+[^.;!?]*[.!]*$)")
_REASON = re.compile(
    r",? (?:as|because|'?cause|cos|coz|since|given that|seeing as|now that|and i (?:only )?ask (?:only )?because) "
    r"|[,?] (?:for|only) (?=i |we |he |she |they |the |my |someone |somebody )|, (?=which (?:is|was|will|would|i|we|makes)\b)",
    re.IGNORECASE,
)
_PURPOSE = re.compile(
    r"(?P<done>.*(?:\d|\b(?:degrees|by \w+|picture|photo|pic|photograph|frame|zoom in on|show)\b).*?),? so (?:that )?"
    r"(?P<aim>(?:i|we)['’]\w+ .+|(?:i|we|those|the|they|he|she|my|our) .+)",
    re.IGNORECASE,
)
"""A command with an amount or a thing, and what it is for: "tilt down by twelve, so that the bench comes into the picture"."""

_EVENT = re.compile(
    r" before (?:(?:the|my|our|his|her) \w+|\w+) (?:walks|comes|gets|turns|shows|leaves|goes|drives|pulls|arrives|sails)"
    r"(?: (?:in|back|here|up|out|off|away|past|by|at \w+))*\s*[.!]*$",
    re.IGNORECASE,
)
_ASKS_WHICH = re.compile(
    r"which (?:one |place |preset )?(?:has|have|had|shows?|contains?|holds?)(?: got)? (?:the )?"
    r"(?:most|more|few|least|less|highest|lowest)",
    re.IGNORECASE,
)
"""The beginning of a question after a list: "gate, yard, roof - which has most bikes", unlike "the gate, which is open"."""

_IDIOMS = re.compile(
    r"(?:,|[.?]| -+) (?:(?:i )?(?:don't|do not) like the look of (?:him|her|them|it|that)|(?:i|we)(?:'ve| have)? lost "
    r"(?:track|count)"
    r"|i keep losing (?:track|count)|i swear(?: to god)?|there's one just \w+ in|do i need (?:my|me|a|an) \w+"
    r"|just wonderin(?:g)? (?:where|what|how|why|if|whether) [\w' ]+|i like to know what's [\w' ]+|can (?:you|yer|u) "
    r"count (?:them|em)|thanks a (?:million|bunch|lot)"
    r"|(?:i |we )?(?:just |only )?(?:need|want)(?:ed)? to know (?:if|whether) (?:(?:i|we) (?:should|need|have to|can)"
    r"|it(?:'s| is) (?:(?:still |really )?worth|time to|too late)|there(?:'s| is) (?:any |a )?point) [\w ]+"
    r"|can (?:you|u) see|trying to "
    r"(?:work out|figure out|see|decide) (?:if|whether|what|which) [\w' ]+|do (?:you|u) (?:reckon|think|know))[.!?]*$",
    re.IGNORECASE,
)
_OCCASION = re.compile(
    r"(?:good \w+[.!,] )?(?:for(?! the next)|ahead of|before|as(?! (?:soon|long|far|much))|since|because|given|in view of|due to"
    r"|owing to|with) [^,]{3,90}?(?:,|(?= i(?:['’]d| should| would| need)))"
    r" (?:and )?(?=(?:please|kindly|could|can|would|will|i need you|i would|i should|i'd|we need|go to|move to|zoom"
    r"|pan|tilt|count|take|check)\b)",
    re.IGNORECASE,
)
_MEANWHILE = re.compile(
    r"(?:whilst|while) (?:i|we|they|he|she)\b[^,.;:?!]{3,60}?"
    r"(?:,|(?= (?:can|could|would|will) you)) (?=(?:please|can|could|would|will)\b)",
    re.IGNORECASE,
)
"""What happens in the meantime, before a request: "while we're shut can you ..."."""

_PAST_NEWS = re.compile(
    r"(?P<news>[^,.;?!]*\b(?:yesterday|ago|earlier|last (?:night|week|month|time))\b[^,.;?!]*)[,.;!] "
    r"(?:anyway,? |so )?(?P<rest>(?:count|pan|tilt|zoom|take|go to|how many|is|are|any)\b.+)",
    re.IGNORECASE,
)
_LIMITING = re.compile(rf"\b(?:{_RESTRICTION}|{_REQUEST}|{WITHDRAWAL})\b", re.IGNORECASE)
_NEWS_BEFORE_QUESTION = re.compile(
    r"(?P<news>[^?]+?)(?:, so|[.;,]) (?P<rest>(?:how many|is|are|what|which|has|have|any|could you tell me) [^.;]+\?*)",
    re.IGNORECASE,
)
_INTO_PICTURE = re.compile(r"\b(?:into|in) (?:the )?(?:picture|view|frame|shot|sight)\b", re.IGNORECASE)
_NEWS_BEFORE_REQUEST = re.compile(
    r"(?P<news>[^?.;]+)[,;] (?P<rest>(?:(?:could|can|would|will) you|(?:please|kindly) (?!do\b)) ?(?:\w+ ){2}.+)", re.IGNORECASE
)
_ATTENTION = re.compile(r"^right, (?=(?:i|we|he|she|they|there|my|our|the)(?:['’]\w+)? )", re.IGNORECASE)
"""A word that calls for attention before a statement; it is no direction."""

_PRONOUNS = re.compile(r"\b(?:it|its|they|their|them|him|his|her|he|she|that|those|these|this|ones?)\b", re.IGNORECASE)
DURATION = re.compile(r"\bfor (?:half )?(?:an?|\d+|[a-z]+) ?(?:seconds?|secs?|minutes?|mins?)\b|\bduration\b", re.IGNORECASE)
FOLLOWING = re.compile(r"\b(?:follow|track|keep|stay|watch)", re.IGNORECASE)
_AS_FAR = re.compile(r"\bas (?:far|high|low|wide|close|tight|much)(?: \w+){0,3}$", re.IGNORECASE)
"""Words before an "as" that says how far to go: "as far left as it will go"."""

_MIN_WORDS = 3  # minimum number of words of a remark, and of a request after it
_MIN_NEWS = 6  # minimum number of words of news before a question or request
_MAX_REMARKS = 3
_MAX_BEGINNINGS = 2  # news, and the occasion after it: "the lads are asking about it, so while we're shut, zoom in on it"


def without_remarks(text: str, presets: tuple[str, ...]) -> str:
    """Return a text without the remarks at its end, and without the news or occasion at its beginning.

    A remark is kept if it contains a word for a command, a restriction or a withdrawal, or the name of a preset. It is also kept if
    both the remark and the instruction before it contain a number: "pan left 20, Dave says thirty".
    """
    for _ in range(_MAX_BEGINNINGS):
        text = _without_beginning(text, presets)
    for _ in range(_MAX_REMARKS):
        shorter = _without_last(text, presets)
        if shorter == text:
            break
        text = shorter
    return text


def _without_last(text: str, presets: tuple[str, ...]) -> str:
    """Return a text without the last of its remarks."""
    if idiom := _IDIOMS.search(text.replace("’", "'")):
        return text[: idiom.start()] + ("?" if "?" in idiom[0] else "")
    text = _EVENT.sub("", text)
    if (purpose := _PURPOSE.fullmatch(text)) is not None and not asks_for_something(_INTO_PICTURE.sub("", purpose["aim"]), presets):
        return purpose["done"]
    for boundary in (*_BOUNDARY.finditer(text), *_REASON.finditer(text)):
        said = text[: boundary.start()]
        if _ASKS_WHICH.match(text[boundary.end() :]):
            continue
        tail = re.sub(r"^which\b", "it", text[boundary.end() :].strip().rstrip(".!"), flags=re.IGNORECASE)
        if _AS_FAR.search(said) is not None:
            continue
        is_correction = NUMBER.search(tail) is not None and NUMBER.search(said) is not None
        is_duration = DURATION.search(tail) is not None and FOLLOWING.search(said) is not None
        parts = [part.strip() for part in tail.split(",")]
        if len(said.split()) > 1 and not (is_correction or is_duration) and all(_is_remark(part, presets) for part in parts):
            return said + ("?" if boundary[0].startswith("?") or text.rstrip().endswith("?") else "")
    return text


def _without_beginning(text: str, presets: tuple[str, ...]) -> str:
    """Return "zoom in on the tile" for "one of the guests has complained, so zoom in on the tile".

    Before a question without pronouns, any words that ask for nothing are news.
    """
    if (occasion := _OCCASION.match(text)) is not None and not asks_for_something(occasion[0], presets):
        return text[occasion.end() :]
    if (meanwhile := _MEANWHILE.match(text)) is not None and not asks_for_something(meanwhile[0], presets):
        return text[meanwhile.end() :]
    if (past := _PAST_NEWS.fullmatch(text)) is not None and not _PRONOUNS.search(past["rest"]):
        news = past["news"].replace("’", "'")
        if is_statement(lexemes_of(news)) and not _LIMITING.search(news):
            return past["rest"]  # "he went left an hour ago, count the cars"
    for pattern in (_NEWS_BEFORE_QUESTION, _NEWS_BEFORE_REQUEST):
        if (
            (match := pattern.fullmatch(text)) is not None
            and len(match["rest"].split()) > _MIN_WORDS
            and not _PRONOUNS.search(match["rest"])
            and _is_news(match["news"], presets)
        ):
            return match["rest"]
    news, *more = re.split(r",? so (?=(?:can|could|would|will) you |please )|, so ", text, maxsplit=1, flags=re.IGNORECASE)
    rest = more[0] if more else ""
    return rest if len(rest.split()) >= _MIN_WORDS and _is_remark(_ATTENTION.sub("", news.strip()), presets) else text


def _is_news(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a text before a question or request is neither a command nor another question."""
    lexemes = lexemes_of(text, presets)
    if len(text.split()) < _MIN_NEWS or asks_for_something(text, presets) or is_question(lexemes) or lexemes[0].has(*VERBS):
        return False
    return is_statement(lexemes) or not any(x.has(*VERBS) for x in lexemes)


def _is_remark(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a text is a statement that asks for nothing."""
    plain = text.replace("’", "'")
    if len(plain.split()) < _MIN_WORDS or asks_for_something(plain, presets):
        return False
    return _STATEMENT.fullmatch(plain) is not None or is_statement(lexemes_of(plain))


def names_command(text: str) -> bool:
    """Return whether a text contains a word for a command or a direction."""
    return _COMMANDING.search(text) is not None


def asks_for_something(text: str, presets: tuple[str, ...]) -> bool:
    """Return whether a text contains words that must not be ignored."""
    plain = _HARMLESS.sub("", text.replace("’", "'"))
    words = set(re.findall(r"\w+", plain.lower()))
    names_preset = any(words & set(re.findall(r"[^\W_]+", preset.lower())) for preset in presets)
    return names_preset or _ASKED.search(plain) is not None or may_withdraw(lexemes_of(plain))

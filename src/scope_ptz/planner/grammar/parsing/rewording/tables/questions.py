"""Patterns for questions and conditions in the text of an instruction, with plainer words that mean the same."""

from __future__ import annotations

import re

from scope_ptz.english import is_plural
from scope_ptz.planner.grammar.parsing.rewording.tables.counts import NO_TOPIC

_STATES = "open|shut|closed|locked|clear|empty|full|free|busy|quiet|blocked|occupied|taken|lit|on|off|up|down|ready|clean|dirty"
_TAGS = "right|correct|yeah|is there|are they|is that right"
_INVERTED = r"(?:is|are|does|do|has|have) (?:the|there|any|anyone|anybody|someone|somebody|all|an?)\b"
_JOINED = re.compile(
    rf"(?P<topic>(?:[\w' -]+: )?)(?P<first>(?:{_INVERTED}|how many )[^?,.;:]+?),? "
    rf"and (?P<second>(?:{_INVERTED}|how many |(?:what|which|where|who)\b)[^?,.;:]+)\?*",
    re.IGNORECASE,
)
_NOT_JOINED = re.compile(r"\b(?:if|or|than|more|fewer|same|both|between|each|total|together|altogether)\b", re.IGNORECASE)
_PRONOUNS = re.compile(r"\b(?:it|its|they|their|them|him|his|her|he|she|that|those|these|this|ones?)\b", re.IGNORECASE)

_MAX_TOPIC = 7  # maximum number of words before "is he ...?"
_WHOLE = r"(?:(?:whole|entire|full|complete)[- ]?(?:site|scene|area|yard|place|view|round)?|all[- ]round|360(?: degrees?)?)"
_QUESTION = r"(?:is|are|do|does|has|have|can|how|who|what|which|where|any)\b"
_ARTICLE = r"(?:the|that|this|these|those|my|our|his|her|their)"
QUESTIONS = (
    (
        rf"^(?:at |in |for )?((?:each|every) (?:preset|position|view|stop|place|one)|all (?:the )?(?:presets|positions|views))"
        rf"\s?[:–-] (?:the )?(?!{_QUESTION})([\w' ]+?) (?:is |are )?((?:{_STATES}) or (?:{_STATES}))\W*$",
        lambda match: (
            match[0] if NO_TOPIC.search(match[2]) else f"at {match[1]}, tell me whether the {match[2]} {_are(match[2])} {match[3]}"
        ),
    ),
    (
        rf"^(?:at |in |for )?((?:each|every) (?:preset|position|view|stop|place|one)|all (?:the )?(?:presets|positions|views))"
        rf"\s?[:–-] (is|are) (the [\w' ]+?) ((?:{_STATES})(?: or (?:{_STATES}))?)\W*$",
        r"at \1, tell me whether \3 \2 \4",
    ),
    (rf"^((?!{_QUESTION})[^,.;:?!]+)\. ((?:{_STATES}) or (?:{_STATES}))\W*$", r"\1, \2?"),
    (
        rf"^(?:(?:do|make|run) )?(?:a )?{_WHOLE} (?:check|scan|sweep|survey|search|look|inspection)\s?[:,.–-]+ "
        rf"({_QUESTION}[^?.;]*)\?*$",
        r"\1 in the whole scene?",
    ),
    (
        r"^(?:(?:please )?(?:answer|just|simply|reply)(?: me)?(?: with)?(?: an?)? )?(?:yes or no|yes/no)(?: please)?\s?[:,.–-]+ "
        rf"(?={_QUESTION})",
        "",
    ),
    (
        rf"^({_ARTICLE} )?((?!{_QUESTION})[\w'’ -]+?) (says?|reads?|shows?) what(?: exactly)?\W*$",
        lambda match: _asked_in_order(match),
    ),
    (
        rf"^(?:the )?(([a-z]+) \d+) ({_STATES})(?: (?:or not|yet|now|still))?\?$",
        lambda match: match[0] if match[2].lower() != "track" and NO_TOPIC.search(match[2]) else f"is {match[1]} {match[3]}?",
    ),
    # "as if they were" is contrary to fact, so it is no likeness.
    (r"\b(looks?|looked|seems?|appears?|sounds?) as (?:if|though) (?!they were)", r"\1 like "),
    (
        r"\b(tell me (?:how many|what|which|where|who|whether)\b[^.;?]*?) and if "
        r"(?=(?:the|there|any|it|they|he|she|my|our)\b[^,.;]*\W*$)",
        r"\1 and whether ",
    ),
    (
        r"^(?:please )?(?:do a )?look (?:(?:at|over|across) the whole (?:scene|area|place)|all around)(?: please)?"
        r"(?:,? and tell me)?[:,] ((?:is|are) [^?]*?)\?*$",
        r"\1 in the whole scene?",
    ),
    (r"^(?:and |so |ok,? )?still (?=(?:see|got|have|spot)\b[^?]*\?)", "can you still "),
    (r"^(?:and |so |ok,? )?still (?=(?:in|on|at|there|visible|open|shut|closed|moving|running)\b[^?]*\?)", "is it still "),
    (r"\bppl\b", "people"),
    (r"\bhows\b", "how's"),
    (r"\bwheres\b", "where's"),
    (r"\bwhoever(?:['’]s| is)\b", "the person"),
    (rf"^(?:so\s+)?(?:nobody|no[ -]?one)(?:['’]s| is| are) (.+?),? (?:{_TAGS})\?$", r"is anyone \1?"),
    (r"^there (is|are)(?:n['’]t| not) (.+), \1 (?:there|they)\?$", r"\1 there \2?"),
    (r"^you can see (.+), can(?:['’]t| not) you\?$", r"can you see \1?"),
    (
        r"^where(?:['’]s| is| are) ((?:the|that|my|our|his|her) [^?.!,;]+)\?\s*"
        r"show (?:it to me|me the thing|me|us|it|them)\s*[.!]*$",
        r"show me \1",
    ),
    (r"(^|\s)y/n\b", r"\1yes or no"),
    (
        r"^(?:but )?looking (?:at|over|around|round|all around|all round) the (?:whole|entire|full) (?:scene|site"
        r"|area|place), ([^?]*)\?*$",
        r"\1 in the whole scene?",
    ),
    (r"^looking all (?:around|round|over)(?: the \w+)?(?: and not only at [\w ]+)?, ([^?]*)\?*$", r"\1 in the whole scene?"),
    (r"^((?:the )?\w+(?: \w+){0,2}?) (is|are) ((?:\w+ )*?\w+ or \w+)\?$", lambda match: _inverted(match)),
    (
        r"^where(?:['’]d| did| have| has) (?:they|he|she|you|we|i) (?:leave|left|put|park|parked) ((?:the|my|our|that"
        r"|his|her) [^,?.]+)[,?.]+ *"
        r"(?:find|show|locate|zoom in on) (?:it|them)\b",
        r"find \1",
    ),
    (r"^time on (the [\w ]+?)\?*$", r"what time does \1 show?"),
    (
        r"^((?:(?:the|that|my|our) )?[\w'’ ]+), (is|are|does|was|can|has|which way (?:is|are)|what (?:is|are)) (?:he"
        r"|she|it|they) ([^?,]+)\?$",
        lambda match: _about_topic(match),
    ),
    (r"^((?:what|which|whats|who)\b[^?,.]+?)[?,] ?can (?:you|u|ye) (?:read|see|make) it(?: out)?\?*$", r"\1?"),
    (r",? if (?:you|ye|we|u) look (?:at|over|around|across) the (?:whole|entire) \w+", " in the whole scene"),
    (
        r"^(?:please )?look (?:at|over|around|across) the (?:whole|entire) (?:scene|area|site|place) and "
        r"((?:tell me|see|say|check) (?:whether|if) [^?.]+?)[?.]*$",
        r"\1 in the whole scene",
    ),
    (r"(?<=\blook )right the way (?=a?round\b)", "all the way "),
    (r"\b(?:all the|the (?:whole|entire|full)) way (?:a?round)(?: (?:us|you|here|the \w+))?(?=\W*$|,)", "all around"),
    (r"(?<=\ball around),? (?:the|in a) (?:full|whole) (?:circle|turn)\b", lambda match: "" if _asks(match.string) else match[0]),
    (r"\baround the (?:whole|entire) \w+(?=\W*$)", "all around"),
    (r"\b(?:the whole|the entire) (?:place|site|area), all around\b", "all around"),
    (r"^taking in the (?:whole|entire) (?:scene|area|site|place), ([^?,]+)(?:, or may i [^?]+)?\?*$", r"\1 in the whole scene?"),
    (r", the (\w+) one or the (\w+) one\?", r", \1 or \2?"),
    (r"\b(preset positions|presets|positions|views) are (?:currently|presently) ", r"\1 are "),
    (r"^considering the (?:whole|entire|full) (?:scene|site|area), ([^?]*)\?*$", r"\1 in the whole scene?"),
    (r"\bdo a look (?:a)?round the whole scene and (?=tell|count)", "sweep the scene and "),
    (r"^(?:the )?(\w+) been (\w+ed)\b([^?]*)\?$", r"has the \1 been \2\3?"),
    (
        r"^(?!(?:is|are|any|how|what|who|which|where|why|has|have|do|does|can|was|anyone|anybody|someone|nobody|keep|stop|start|try)\b)"
        r"(\w+) (coming|leaking|rising|dripping|standing|parked|blocking|lying|waiting) ([^?]+)\?$",
        r"any \1 \2 \3?",
    ),
    (r", not (?:just|only) the (?:ones|one) (?:in (?:shot|view|frame|the picture)|here|you can see)\W*$", ""),
    (r"\bdetermine (?=the )", "tell me "),
    (r"\b(?:over|across|through) the (?:full|whole|entire) 360(?: degrees)?", "all around"),
    (r"^more (\w+) or more (\w+)(?: in view| here)?\?(?: count both)?\W*$", r"are there more \1 than \2?"),
    (
        r"^(if (?:the|a|an|any)\b[^,]*? (?:is|are)\b[^,]*?) "
        r"(?=(?:(?:could|can|would|will) you )?(?:follow|zoom|take|pan|tilt|count|track|snap|tell)\b)",
        r"\1, ",
    ),
    (r"\b(presets have you got) in there\b", r"\1"),
    (r", (?:the )?whole (?:site|place|yard|area), look all around\b", " all around"),
    (r"\b(?:across|over) the (?:full|whole|entire) surroundings\b", "in the whole scene"),
    (r", not (?:just|only) what is in (?:the )?(?:frame|view|shot|picture)\W*$", ""),
    # Corrections: "how many impala, I mean kudu, are there?", "bikes at the racks? Bike racks I mean"
    # Conditions
    (
        r"^(raining|snowing|dark|foggy|windy|wet|busy|quiet|icy|flooded|sunny|cloudy|clear|muddy|dusty)(?: (?:out"
        r"|down|up))?(?: there| here)?\?$",
        r"is it \1?",
    ),
    (r"^(?:please )?(?:determine|check|tell me|report) the state of (the [\w ]+?)[:,]? (\w+ or \w+)\?*$", r"is \1 \2?"),
    (
        r"[.?!] (?:please )?(?:look|check) (?:at|over|around|across) the (?:whole|entire|full) \w+ (?:before (?:you "
        r")?answer(?:ing)?|first)\W*$",
        " in the whole scene?",
    ),
    (
        r"^the ([\w ]+?), (what|which) (colou?r|size|make|shape) (is|are) (?:the |his |her |its |their )([\w ]+?)\?*$",
        r"\2 \3 \4 the \5 of the \1?",
    ),
    (r"^looking all (?:a)?round(?: us| you| the \w+)?, ([^?]*)\?*$", r"\1 in the whole scene?"),
    (r"^all (?:a)?round (?:the \w+|us|you)[:,] ([^?]*?)(?: anywhere)?\?*$", r"\1 in the whole scene?"),
    (
        r"^(?:confirm|verify) (?:that )?(?:the )?((?:(?!(?:is|are)\b)[\w ])+?) "
        r"(lit|open|shut|closed|locked|on|off|clear|empty|full)(?:,? "
        r"(?:yes or no|y/n))?\W*$",
        lambda match: f"{'are' if is_plural(match[1].split(' ')[-1]) else 'is'} the {match[1]} {match[2]}?",
    ),
    (r"^they (\w+ed|put|got|done) (.+?) yet\?$", r"have they \1 \2 yet?"),
    (r"\bif there(?:['’]s| is) (an? \w+) in, ", r"if there is \1, "),
    (r"^(?!(?:is|are|any|anyone|what|which|how|it|there|nothing|who)\b)(\w+(?: \w+)?) visible\?$", r"is \1 visible?"),
    (r"^looking (?:a)?round the whole \w+, ([^?]*)\?*$", r"\1 in the whole scene?"),
    (r"\bgo to each place in the list and\b", "at each preset,"),
    (r"^see if there(?:['’]s| is) (an? [\w ]+?), and if there is, ", r"if there is \1, "),
    (r"^take in the whole \w+ and tell me,? ([^?]*?)(?: anywhere)?\?*$", r"\1 in the whole scene?"),
    (r"\b(?:run|go) through (?:all )?the presets and check at each one (?=whether|if)", "at each preset, check "),
)
"""Patterns with the words that replace them."""


def _are(things: str) -> str:
    """Return the verb for a noun phrase."""
    return "are" if is_plural(things.split(" ")[-1]) else "is"


def _asks(text: str) -> bool:
    """Return whether a text asks for what is seen, so that "all around" is where to look and no turn."""
    return re.search(r"\?|\b(?:count|how many|tell|report|check|see if|whether|find|look for)\b", text, re.IGNORECASE) is not None


def _asked_in_order(match: re.Match[str]) -> str:
    """Return "what does the sign by the door say?" for "sign by the door says what"; other texts unchanged."""
    if NO_TOPIC.search(match[2]):
        return match[0]
    head = re.split(r" (?:on|at|by|in|of|over|near|next|behind|above|under|beside|outside) ", match[2])[0].split()[-1]
    return f"what {'do' if is_plural(head) else 'does'} {match[1] or 'the '}{match[2]} {match[3].removesuffix('s')}?"


def _about_topic(match: re.Match[str]) -> str:
    """Return "is that man carrying a box?" for "that man, is he carrying a box?"; other texts unchanged."""
    if len(match[1].split()) > _MAX_TOPIC or NO_TOPIC.search(match[1]):
        return match[0]
    article = "" if re.match(r"(?:the|that|my|our)\b", match[1], re.IGNORECASE) else "the "
    return f"{match[2]} {article}{match[1]} {match[3]}?"


def _inverted(match: re.Match[str]) -> str:
    """Return "is the gate open or shut?" for "the gate is open or shut?"; a question is returned unchanged."""
    if re.match(r"(?:what|which|who|where|how|when|why|is|are|any|there|it|this|that|tell|check|see)\b", match[1], re.IGNORECASE):
        return match[0]
    article = "" if match[1].lower().startswith("the ") else "the "
    state = re.sub(r" or (?:no|not)$", "", match[3], flags=re.IGNORECASE)
    return f"{match[2]} {article}{match[1]} {state}?"


_UNPUNCTUATED = re.compile(
    r"(?P<news>(?:(?:well|so|oh|ok|okay|hey|right|look|listen) )*(?:i|we|he|she|they|somebody|someone|something|it)\b(?:['’]\w+)?"
    r"(?: [\w'’-]+){3,}?(?<! what)(?<! where)(?<! who)(?<! how)(?<! which)(?<! why)(?<! when)(?<! whether)(?<! if)"
    r"(?<! that)(?<! and)(?<! or)(?<! but)(?<! than)(?<! as)(?<! know)(?<! tell)(?<! see)(?<! check)(?<! wonder)(?<! ask)(?<! of)"
    r"(?<! to)(?<! out)(?<! about)(?<! me)(?<! sure)(?<! matter)) "
    r"(?P<question>(?:(?:is|are|was|were) (?:the|there|any|anyone|anybody|those|these|"
    r"my|our)\b|what colou?r (?:is|are|was) )(?! (?:more|other)\b)[^,.;:?!]{6,}?)\?*",
    re.IGNORECASE,
)
"""News, and a question that follows it without punctuation: "I heard a bang are there any people on the platform"."""


def with_question_apart(text: str) -> str:
    """Return "I heard a bang. are there any people?" for "I heard a bang are there any people"; other texts unchanged."""
    match = _UNPUNCTUATED.fullmatch(text.strip())
    return text if match is None else f"{match['news']}. {match['question']}?"


def with_separate_questions(text: str) -> str:
    """Return "is the bin full? how many cars are there?" for "is the bin full, and how many cars are there?".

    A second question with a pronoun is separated only if the first is a count, because the pronoun then refers to what is counted.
    """
    match = _JOINED.fullmatch(text.strip())
    if match is None or _NOT_JOINED.search(text):
        return text
    first, second = match["first"], match["second"]
    if re.match(r"wh", second, re.IGNORECASE) and not first.lower().startswith("how many"):
        return text
    if _PRONOUNS.search(second) and not first.lower().startswith("how many"):
        return text
    return f"{match['topic']}{first}? {second}?"

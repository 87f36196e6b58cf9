"""Patterns for counts and comparisons of counts in the text of an instruction, with plainer words that mean the same."""

from __future__ import annotations

import re

from scope_ptz.english import plural

NO_TOPIC = re.compile(
    r"\b(?:zoom|pan|tilt|turn|go|take|count|follow|track|look|find|check|tell|show|read|see|how|what|which|who|is|are|was|has|if|there|any"
    r"|please|ok|okay|hey|hi|hiya|hello|right|so|now|and|left|up|down|home|move|swing|point|aim|focus|hold|wait|stop|yes|no)\b",
    re.IGNORECASE,
)
"""Words which show that a text is not a noun phrase."""

_THINGS = r"(?!there\b)[\w-]+(?: (?!there\b|are\b|is\b|at\b|in\b|on\b|by\b|with\b|and\b)[\w-]+){0,3}"
_COUNTING = r"(?:please )?(?:(?:can|could) you )?(?:count|how many|tell me how many|give me the number of)\b"

COUNTS = (
    (
        r"^(?:(?:i|we) )?(?:just )?(?:need|want|doing|do) (?:an? |the |my |our )?(?:quick )?"
        rf"(?:head ?count|tally|count|figure|number|roll call)(?: for (?:the|my|our) [\w ]{{2,30}}?)?\s*[:,.;-]+ (?={_COUNTING})",
        "",
    ),
    (r"^head ?count(?: (?:at|in|on|for) (?:the |my |our )?([\w ]+?))?[:,;-]+ (how many .+)$", lambda match: _asked_at(match)),
    (r"\bon (the (?:whole|entire|full) (?:scene|view|picture))\b", r"in \1"),
    (
        r"\b(?:(?:have|take) a )?(?:go|look|turn|scan|sweep|pan) (?:all )?(?:a?round|over) the (?:whole|entire|full) (\w+) and "
        r"count (.+)$",
        r"count \2 in the whole scene",
    ),
    (r"\ball a?round,? (?=(?:in )?the (?:whole|entire|full) (?:scene|view|picture|panorama)\b)", "in "),
    (r"^([\w -]+?), (?:the )?number of ([\w -]+?)\?*$", r"\1, how many \2?"),
    (rf"\b(how many {_THINGS}) and how many (?={_THINGS}(?: are)? (?:at|in|on) (?:the )?[\w -]+?\W*$)", r"\1 and "),
    (r"\b(are|is|were|was) (?:sat|stood|parked up) (?=at |in |on |by )", r"\1 "),
    (r"\bdo the counting of ", "count the "),
    (r"\bwhich is having\b", "which has"),
    (r"\bneed a number: ", "count the "),
    (
        r"(?<!and)(?<!then)(?<!please)(?<!you)(?<!to)(?<!can)(?<!could)(?<!or)(?<!just)(?<![,.;:]) (?=tell me (?:if"
        r"|whether|how|what)\b)",
        ", ",
    ),
    (r"\btally up\b", "count"),
    (r"\b(?:object|item|thing)s? count(?:s|ing)?[,:] (?=(?:the )?[a-z])", "count "),
    (r"\b(how m[ae]ny [\w ]+? (?:have (?:we|i|you) got|do (?:we|i|you|they) (?:still )?have)) left\b", r"\1"),
    (r"^head ?count at (the [\w -]+?) ?[-–—,:] ?how many (\w+)\W*$", r"how many \2 are at \1"),
    (r", how many, then\b", ", then"),
    (r"\b(how many [\w ]+?) are out\?*$", r"\1 are there?"),
    (r"^([\w ]+?), how many can (?:you|u) see\W*$", lambda match: _counted(match)),
    (r"^(?!.*\b(?:then|and)\b)([\w' ]+?)\. (find|follow|zoom in on|track) it\W*$", lambda match: _found(match)),
    (r"^([\w ]+?)(?: in view)?,? (?:how many|give (?:us|me) a (?:number|count|figure))\W*$", lambda match: _counted(match)),
    (
        r"\b(?:currently|presently|right now|at present) "
        r"(?=visible\b|(?:in|within|inside|on) (?:the |this )?(?:view|sight|frame|shot|picture|image|screen|camera)\b)",
        "",
    ),
    (r"\b((?:how many|number of) [\w ]+?)(?: are)? out (?=(?:at|on|in) the )", r"\1 "),
    (
        r"^(?:any|are there any) more ([\w ]+?) (at|in|on) (.+?) than (?:at |in |on )?(.+?)\?*$",
        r"are there more \1 \2 \3 than \2 \4?",
    ),
    (r"^out of (.+?),? and (.+?), (?:where are|where is|which has) the most ([\w ]+)\?*$", r"which has the most \3, \1 or \2?"),
    (r"^all presets, (\w+?)s? count(?: at each(?: one)?)?\W*$", lambda match: f"count the {plural(match[1])} at each preset"),
    (
        r"^count (?:the )?([\w ]+?),? then (?:the )?(?!(?:go|take|pan|zoom|tilt|count|turn|move|tell|check|follow"
        r"|track|snap|look|report)\b)"
        r"([\w ]+)\W*$",
        r"count the \1, then count the \2",
    ),
    (r"^((?:number of|how many)\b.*) in (picture|shot|frame)(?=\W*$)", r"\1 in the \2"),
    (r"^(.*\b(?:count|how many)\b.*)[,.;] i (?:just |only )?want(?:ed)? to know how many [\w ]+\W*$", r"\1"),
    (
        r"\b(how m[ae]ny [\w ]+?) (?:have|has) (?:arrived|got in|turned up|come in|gathered|shown up)\b"
        r"(?: so far| already| by now| today| tonight| this (?:morning|afternoon|evening))?",
        r"\1 are there",
    ),
    (r"\b(how m[ae]ny [\w ]+?) are left\b", r"\1 are there"),
    (r"\b(count up) them (?=\w)", r"\1 the "),
    (r"^count they (?=\w+ \w+)", "count the "),
    (r"\bmore ([\w ]+?) round it(?: tonight| now)?,", r"more \1,"),
    (
        r"\b(how m[ae]ny [^,.;?]+?) (?:have (?:we|i)(?: still)?(?: got)?|we(?:['’]ve)? got|have you got|you(?:['’]ve| "
        r"have)? got|have they(?: put out| got| "
        r"left(?: out)?)|are you seeing|do you make it)(?= (?:at|in|on|down|up|over|out|by)\b|\W*$)",
        r"\1 are there",
    ),
    (r"\b(how many [^?.]*?\b(?:is|are)) (?:currently|presently|now|still) (?=\w)", r"\1 "),
    (
        r"^((?:so |now |and )?(?:how many|is|are|any|has|have|did|who|what)\b.*?) this (?:morning|afternoon|evening"
        r"|minute)(?=[?.!]*$)",
        r"\1",
    ),
    (
        r",? (?:in |over |across |for )?(?:an? |the )?(?:full |whole |entire |complete )?360[ -]?(?:degrees? )?"
        r"(?:view|sweep|scan|scene)\W*$",
        " all around",
    ),
    (
        r",? (?:and )?not (?:just|only) (?:in |at |on )?(?:this|that) (?:part|bit|area|side|corner|section|end)"
        r"(?: of (?:it|the (?:picture|scene|view|frame|shot)))?",
        "",
    ),
    (r"^head ?count(?: please)?,? (?:just|only) (?:the )?(?:ones|those) (?=with|in|wearing)", "count the people "),
    (
        r"^compare the (?:number|numbers|count) of ([\w ]+?) (?:in|at|on) (.+?) (?:with|to|and|against) (?:the "
        r"(?:number|count|one)s? )?(?:in|at|on) "
        r"(.+?)\W*$",
        r"which has more \1, \2 or \3?",
    ),
    (r",? (?:and )?not (?:just|only) (?:here|there)(?=\W*$)", ""),
    (
        r",? (?:and )?not (?:just|only) (?:what(?:['’]s| is| (?:you|we|i) (?:can )?see| the camera (?:shows|sees)) )?"
        r"(?:(?:on |in )?(?:the |this )?(?:present |current )?(?:screen|view|picture|frame|shot)|visible(?: now)?)(?=\W*$)",
        "",
    ),
    (
        r"^((?:please )?(?:how many|count|(?:the )?number of|(?:give|get) (?:me|us) (?:a|the) (?:count|number|total) of)\b"
        r"[^?.!,;:]*?)[,;] (?:the )?(?:whole|entire|full|complete) "
        r"(?:yard|site|area|lot|place|field|grounds?|park|premises|plot|property|pitch"
        r"|compound|campus|estate|farm|harbou?r|port|depot|works)\W*$",
        r"\1 in the whole scene",
    ),
    (
        r"^((?!.*\b(?:which|more|fewer)\b)[\w' ]*?)\b(\w+s),? (?:vs\.?|versus|against) ([\w' ]*?\b\2)"
        r"((?: (?:in|at|on) (?:the|this) [\w ]+?)?)[,;:] "
        r"(?:numbers|counts|totals|figures|count both|how many of each|both numbers)(?: please| pls)?\W*$",
        r"count the \1\2 and the \3\4",
    ),
    (
        r"^([\w' ]+?) (?:plus|and) ([\w' ]+?)((?: (?:in|at|on) (?:the|this) [\w ]+?)?)[,;:] "
        r"what(?:['’]s| is) the (?:sum|total|combined (?:number|total))\W*$",
        lambda match: f"what is the total of {match[1][:1].lower()}{match[1][1:]} and {match[2]}{match[3]}?",
    ),
    (
        r"\b(rank|order|sort) ((?:all )?(?:the )?(?:\w+ )?(?:presets|positions|views) by (?:the )?(?:number|count) of [\w ]+?), "
        r"(?:highest|most|largest|biggest|busiest|fullest|lowest|fewest|smallest|quietest|best) first\b",
        r"\1 \2",
    ),
    (r"\bin each case\b", "at each one"),
    (r"\bin (?:the )?(?:list(?:ed)?|preset) order\b|\bin the order (?:(?:they(?:['’]re| are) )?listed|of the list)\b", "in order"),
    (r"\bexcl?\. (?=\w)", "except "),
    (r"\b(?:no\.|qty\.?|quantity) (?:of )?(?=[a-z])", "number of "),
    (
        r"\b(on|of|at|the|count|count me|find|see|follow) them (?!for|at|in|on|across|until|as|with|to|from|and|is"
        r"|was|towards|past|all|\w+ing\b|wears?\b|ha(?:s|ve)\b|carr(?:y|ies)\b|holds?\b|rides?\b|sits?\b|stands?\b|walks?\b)"
        r"(?=(?:\w+ )?\w+s\b)",
        r"\1 the ",
    ),
    (
        r"\bdo (?:us|me) a (?:full |quick )?(?:sweep|scan)(?: right round| all round| all around| round| around)* and "
        r"(?=(?:tell|count|see)\b)",
        "sweep the scene and ",
    ),
    (r"\bcount (the [^,.;]+?) and (?:then|afterwards|after that) the ", r"count \1 and then count the "),
    (
        r"\b(?:let me have|give me|i need|i want|get me) (?:one|a) (?:figure|number|count|total) for (the [\w ]+?) "
        r"and (?:another|one"
        r"|a second one|one more) for (the [\w ]+)",
        r"count \1, then count \2",
    ),
    (r"^(.*\bhow many [\w ]+?) (?:right |over |out |down |up )there\?*$", r"\1?"),
    (
        r"\b(?:in|on|across|over|a?round|throughout) the (?:whole|entire) (?:grounds?|stadium|lot|park|car ?park"
        r"|garden|field|harbou?r|port|yard|property|premises|estate|site|farm|compound|campus)\b",
        "in the whole scene",
    ),
    (
        r"^(?:take a |have a )?look (?:everywhere|all (?:a)?round|all over)(?: (?:around|in|on) the \w+| the \w+)?,? (?:and )?"
        r"((?:is|are|how many|can)\b[^?]*)\?*$",
        r"\1 in the whole scene?",
    ),
    (r"\b(?:give|get) (?:us|me) (?:a|the) (?:number|count|figure|total|tally) (?:on|for|of) ", "count "),
    (
        r"^(count [\w -]+?),? (?:(?:with)?in(?:side)? )?(?:the |this )?current (?:view|frame|picture)(?=\W*$|[.;,])",
        r"\1 in the current view",
    ),
    (r"^full[- ]scene count: (?:the )?([\w ]+)", r"count the \1 in the whole scene"),
    (r", and, separately, (?=the )|\band, separately, (?=the )", " and "),
    (r"\bcount (the [\w ]+?) again(?=[.,;!?]|$| and\b)", r"count \1"),
    (r"\b(how m[ae]ny [\w ]+?) are standing (?=at|in|on|by|outside)", r"\1 are "),
    (r"^head ?count[,:] (?:of )?(people\b[\w -]*|[\w ]+ in [\w -]+)\W*$", r"count the \1"),
    (r"\bhow many ([\w ]+?) you (?:are able to|can) see\b", r"how many \1 can you see"),
    (r"\bnumber fo\b", "number of"),
    (
        r"^((?:how many|count|number of)\b[^?.!]*?), (?:the )?whole (?:yard|site|scene|area|lot|place) i mean\W*$",
        r"\1 in the whole scene",
    ),
    (
        r"^((?:how many|number of) [\w -]+?),? (?:(?:with)?in(?:side)? )?(?:the |this )?current (?:view|frame|picture)\W*$",
        r"\1 in the current view",
    ),
    (r"^((?:how many|number of|count) [\w -]+?),? (?:in )?all directions\W*$", r"\1 in the whole scene"),
    (
        r"^if (?:you|we|i) (?:had|have|took|take) a look (?:all the way |all |right )?(?:a)?round, ([^?]*?)(?: "
        r"altogether| in all| in total)?\?*$",
        r"\1 in the whole scene?",
    ),
    (r"\b(how many [\w ]+?)(?: are)? lying (?:around|about)\b(?: here| there)?", r"\1 are there"),
    (r"\b(how many [\w ]+?) are (?:on|in)(?=[,.;?]|$)", r"\1 are there"),
    (
        r"^([\w ]+?)[,.] (?:full|whole|entire) (?:scene|area|view|site)[,.] how many\?*$",
        r"how many \1 are there in the whole scene?",
    ),
    (r"^(taking in the (?:whole|entire) (?:scene|area|site|place))(?: rather than [^,]+), ([^?]+)\?*$", r"\2 in the whole scene?"),
    (r"\b(how many [\w ]+?) (?:are (?:stored|kept|stacked|lying)|(?:do )?(?:lie|sit|stand)) (?=at|in|on)", r"\1 are "),
    (
        r"^(?:please )?look (?:at|over|around|across) the (?:whole|entire) \w+ and (?:give me a count of|count) "
        r"(?:the )?([\w ]+?)\W*$",
        r"count the \1 in the whole scene",
    ),
    (r"\b(how many [\w ]+?) are up (?=at|in|on)", r"\1 are "),
    (r"\b(how many [\w ]+?) are there all around the (?:yard|pit|court|field|site|place)\b[^?.]*", r"\1 are there all around"),
    (
        r"^(?:do|doing) the rounds, every preset, head ?count of (?:the )?([\w ]+?)(?: at each one)?\W*$",
        r"count the \1 at each preset",
    ),
    (r"\btell me how many people are there and whether\b", "count the people, then tell me whether"),
    (
        r"\b(?:wants to know|have asked for|asked for|has asked for) the number of ([\w ]+?) (?:you can see|in this view)\b[^.;]*",
        r"so count the \1",
    ),
    (r"\bcan you make out (how many [\w ]+?) there are\b", r"\1 are there"),
    (r"^look at the whole \w+ and tell me (how many [\w ]+?) there are\b", r"\1 are there in the whole scene"),
    (r"\b(?:go|run) through every preset and tell me (how many [\w ]+?) there are at each one\b", r"\1 are there at each preset"),
    (r"\b(how many [\w ]+?) (?:are there )?in total, looking all around\b", r"\1 are there all around"),
    (r"(?: in the whole \w+)?,? look in every direction\W*$", " in the whole scene"),
)
"""Patterns with the words that replace them."""


def _counted(match: re.Match[str]) -> str:
    """Return "count the bins" for "bins, how many?". If "bins" is not a noun phrase, the text is unchanged."""
    return match[0] if NO_TOPIC.search(match[1]) else f"count the {match[1]}"


def _found(match: re.Match[str]) -> str:
    """Return "find the dummy" for "dummy. Find it". If "dummy" is not a noun phrase, the text is unchanged."""
    return match[0] if NO_TOPIC.search(match[1]) else f"{match[2]} the {match[1]}"


def _asked_at(match: re.Match[str]) -> str:
    """Return "how many nurses are there at the ward" for "headcount at the ward: how many nurses are there"."""
    if not match[1]:
        return match[2]
    asked = re.sub(r" (?:do|can) you (?:see|count|make out)\W*$| are there\W*$|\W+$", "", match[2])
    return f"{asked} are there at the {match[1]}?"

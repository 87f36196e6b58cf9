"""Patterns for wordings about close views, pictures, lists of presets and things to follow, with the plainer words for them."""

from __future__ import annotations

import re

_PICTURES = "photo|picture|pic|snap|shot|still"
_MOVED = re.compile(r"\b(?:left|right|up|down|(?:pan|tilt|zoom)\w*(?! in on| on))\b[^,.;]*[,.;] $", re.IGNORECASE)
"""A clause that turns or zooms the camera, at the end of a text."""

_MOVES = re.compile(r"\b(?:pan|tilt|zoom|turn|move|swing|rotate|look|lift|raise|lower|left|right|up|down|in|out)\b", re.IGNORECASE)

_WORD = re.compile(r"\w")


def _wanted_in_frame(match: re.Match[str]) -> str:
    """Return "zoom in on the crane" for "I want the crane in the picture". Beside a move, the wish is the reason for the move."""
    if _MOVES.search(match.string[: match.start()]):
        return match[0]
    is_alone = not _WORD.search(match.string[: match.start()] + match.string[match.end() :])
    return f"zoom in on {match[1]}" if is_alone else f"let me see {match[1]}"


VIEWS = (
    (r"\b(in) (?=(?:picture|image)(?:[,.;?!]|$| (?:please|now|right now|so|and|then)\b))", r"\1 the "),
    (r"^preset (?:recall|call[- ]?up|call|selection|select)(?: test)?[:,]? (?=\w)", "go to "),
    (r"^(?:the )?presets? list(?: first)?(?=\W*$|[,.;]| then\b| and\b)", "list the presets"),
    (r"([,.;] (?:and )?(?:then )?)image(?=\W*$)", r"\1take an image"),
    (
        r"\b(?:know|see|hear|tell me) (?:what|which) (?:(?:camera|memory|stored|saved|preset) )?"
        r"(?:places|positions|spots|presets|views) (?:this|the|that) (?:camera|thing|unit|device|system) "
        r"(?:offers|has|knows|stores|remembers|holds)(?: stored| saved)?\W*$",
        "list the presets",
    ),
    (r"^((?:list|show|tell me|give me)\b.*\b(?:positions|presets|places|spots|views)) (?:which|that) are \w+ed\b[\w ]*\W*$", r"\1"),
    (r"^check out ((?:the|that) [\w ]+?), zoom (?:in )?(?:on|onto|to) it\b", r"zoom in on \1"),
    (r"^(?:i )?can(?:['’]?t|not) (?:make out|see|read) (the [\w ]+?)(?: from here)?, zoom in on it\b", r"zoom in on \1"),
    (
        r"\bi(?:['’]d| would)? (?:like|want|need) (the [\w ]+?)(?: to be)?(?: (?:properly|nicely|neatly|well|tightly))? framed"
        r"(?: (?:properly|nicely|neatly|well|tightly|up))*(?=\W*$|, )",
        lambda match: _wanted_in_frame(match),
    ),
    (r"\bi(?:['’]d| would) like (the [\w ]+?) framed\b.*$", r"zoom in on \1"),
    (
        r"\b(?:i|we)(?:['’]d| would)? (?:like|want|need) ((?:the|that|this) [\w'’ ]+?)(?: to be)?"
        r"(?: (?:nicely|right|properly|well|fully))? (?:in|into) (?:the )?"
        r"(?:frame|shot|view|picture)(?=\W*$|[,.;]| for (?:the|my|our|an?)\b)",
        lambda match: _wanted_in_frame(match),
    ),
    (
        r"\b(?:get|give|show|bring|find) (?:me|us) ((?:the|that|this) [\w'’ ]+?),? "
        r"(?:up close|close[- ]?up|nice and close|in close|very close)(?=\W*$|[,.;])",
        r"zoom in on \1",
    ),
    (
        r"^(?:please )?search (?:please )?(?:for )?((?:the|an?|my|our|that) "
        r"(?![\w ]*\b(?:yard|site|area|scene|place|room|field|building|street|road|car park|grounds?) and)[\w'’ ]+?) "
        r"and (?:then )?(?:come|go|get|move|zoom)(?: in)? "
        r"(?:close|closer|near|nearer|in)?(?: to| on)? (?:it|him|her|them)(?=\W*$|[,.;])",
        r"zoom in on \1",
    ),
    (r"^for the next ([\w ]+? (?:seconds|minutes)), ((?:follow|track)\b.*?)\W*$", r"\2 for \1"),
    (rf"\b((?:{_PICTURES})\b.*)\btake one there(?: as well| too)?\b", r"\1take a picture"),
    (rf"\bfinish with a ({_PICTURES})\b", r"then take a \1"),
    (
        r"^(?:somebody|someone)(?:['’]s| has)? (?:left|lost|dropped|parked|dumped) (?:a|an|their|his|her) ([\w ]+?)"
        r"(?: (?:out|there|here|outside|last night|earlier|today|again|somewhere))*, (?:please |can you |could you )?"
        r"(find|zoom in on|look for) (?:it\b|the [\w ]+?(?=\W*$|[,.]))",
        r"\2 the \1",
    ),
    (
        r"^i(?:['’]ve| have)? (?:lost|misplaced) (?:the|my) ([\w ]+?)(?: again)?, (?:please |can you |could you )?"
        r"(find) it(?: for me)?\?*$",
        r"\2 the \1",
    ),
    (
        rf"\b((?:{_PICTURES}|image)) of what(?:ever)? (?:you(?:['’]re| are)|(?:it|the camera)(?:['’]s| is)) "
        r"(?:(?:now|currently) )?(?:seeing|showing|(?:looking|pointing|pointed|aimed) at)(?: (?:now|right now|at the moment))?",
        r"\1",
    ),
    (
        r"\b(zoom (?:in|out)(?: (?:by )?[\w.]+)?) on what (?:we|you|i) (?:have|can see|see)(?: (?:now|here|right now"
        r"|at the moment))?\b",
        r"\1",
    ),
    (r"^cent(?:er|re) and zoom (?:in )?on ", "zoom in on "),
    (r"\b(take|get|grab) another wan\b", r"\1 another picture"),
    (r"^(?:please )?(?:photo|pic) (?=every|each|all the)", "photograph "),
    (r"\bget in (?:nice and )?(?:close|tight) (?:on|to) ", "zoom in on "),
    (r"^tight (?:in )?on ", "zoom in on "),
    (
        r"^where(?:['’]?s| is) ((?:the|that|my|our) [^?.!,;]+?)(?: got to| gone)?[?,]\s*(?:zoom (?:in )?(?:on|to)"
        r"|find|show me) (?:it|him|her|them)(?: for (?:me|us)| and show (?:me|us)| please| quickly| now)*(?=\s*[.!]*$|[,.;] )",
        r"zoom in on \1",
    ),
    (r"^keep an eye on (.+?),? and follow (?:it|him|her|them)(?: for (?=.+$)|$)", r"follow \1 for "),
    (r"\b(photo|picture|still|snap|pic)\b(.*?) and do the same(?: thing)? there\b", r"\1\2 and take a picture"),
    (r"\btake another(?: one)?(?: there)?(?=[.,;!?]|$| and\b| then\b)", "take another picture"),
    (r"\bcloseup\b", "close-up"),
    (r"^(?:i )?need to see ([^,.]+?)[,.] zoom (?:in )?(?:to|on|onto) it\b", r"zoom in on the \1"),
    (
        r"\b(?:i )?(?:wish|want|would like|need) to (?:examine|inspect|study) (?P<thing>[^,.;]+?)"
        r"(?P<detail> more closely| up close| closely| in detail)?\W*$",
        lambda match: _inspected(match),
    ),
    (r"^(?:stick|stay|keep) (?:with|on) (?=(?:the|that|him|her|it|them|this)\b(?! (?:left|right|move|pan|tilt|zoom)))", "follow "),
    (r"\b(?:i )?(?:need|want|would like|['’]d like)(?: to)? (?:see|look at) (?:more close|closer|more closely) ", "zoom in on "),
    (
        r"\b(?:i )?(?:need|want|would like|['’]d like) to (?:see|look at) ([\w ]+?) (?:up close|close up|close-up|from close up)",
        r"zoom in on \1",
    ),
    (
        r"^((?:zoom|find|follow|track|show|look at|get)\b.*?) (?:which|that|wich) (?:is|are) (?=(?:on|in|at|by|near"
        r"|behind|under|beside|next to)\b)",
        r"\1 ",
    ),
    (r"^(?:a )?close(?:r)?(?: |-)?(?:look|view|up), (?:the )?(?=[a-z][\w -]*\W*$)", "zoom in on the "),
    (rf"\b(?:do|get|give) (?:us|me) (?=(?:a|an|another|one|some) (?:(?!close)\w+ ){{0,2}}(?:{_PICTURES})\b)", "take "),
    (rf"\b((?:{_PICTURES})) of what(?:ever)?(?:['’]s| is) (?:up |down |over |out )?there\b", r"\1"),
    (r"\bget ((?:the|that) [\w ]+?) (?:up close|nice and close|close up)(?=\W*$)", r"zoom in on \1"),
    (
        r"^i (?:want|need|would like) to see ((?:the|that) [\w ]+?)(?: from (?:near|close)| up close| better| properly)?[,.] zoom "
        r"(?:in )?(?:on|onto|to) it\b",
        r"zoom in on \1",
    ),
    (
        rf"\b((?:{_PICTURES})) of what(?:ever)? (?:you(?:['’]ve)?(?: have)? got|we(?:['’]ve)?(?: have)? got|you have|you see|i see)"
        r"(?: right now| now| there| here| on screen)*",
        r"\1",
    ),
    (
        r"^.*\b(?:views|spots|presets|positions|places) (?:are|have (?:we|you|i)(?: got)?|there are) (?:saved|stored"
        r"|set up)[^,.?]*[,.?] "
        r"(?:so )?(?:read|give) (?:me|us) the list\b.*$",
        "list the presets",
    ),
    (
        r"\bread (?:me |us )?(?:off |out )?(?:me )?the list(?: of (?:the |all )?(?:saved |stored )?(?:spots|positions|presets|views"
        r"|places))(?: for (?:me|us))?",
        "list the presets",
    ),
    (
        r"^(?:what|which) (?:presets|saved views|saved positions|saved spots) (?:have (?:we|you|i) got|do (?:we|you"
        r"|i) have|are there|are)"
        r"(?: saved| stored| set up| programmed)?(?: (?:in|on|for|with) (?:this|the|here)(?: (?:one|camera|thing"
        r"|system|site))?)?\W*$",
        "list the presets",
    ),
    (
        r"^(?:what|which) (?:(?:camera|memory|stored|saved|preset|preprogrammed|programmed) )?"
        r"(?:places|positions|spots|presets|views|locations|memories) "
        r"(?:does (?:it|this|the|this thing|the thing|he|she)(?: camera| unit| system| device)?|do you)"
        r"(?: already| currently)? (?:know|have|remember|store|offer|support|hold)"
        r"(?: already| about| of| stored| saved| in memory)*\W*$",
        "list the presets",
    ),
    (
        r"^what are (?:the|all the|your|our) (?:saved |stored )?(?:positions|presets|views|spots) (?:called|named)\b",
        "list the presets",
    ),
    (r"^(?:a )?close-?up of (the [\w ]+?) (?:required|needed|wanted|please)\W*$", r"zoom in on \1"),
    (
        r"\b(track|follow) (?:the )?(?!it\b|him\b|her\b|them\b)([a-z][\w ]*?),? (?:duration|for|time)?:? ?(\d+) ?(s"
        r"|secs?|seconds?|mins?|minutes?)\b",
        r"\1 the \2 for \3 \4",
    ),
    (r"(?<=, )(follow|track) (?:for )?(\d+|\w+) (s|secs?|seconds?|mins?|minutes?)\W*$", r"\1 it for \2 \3"),
    (
        r"\bi (?:should|would|['’]d) be (?:very |most )?(?:grateful|glad|obliged) for a (?:closer|better|good) look at ",
        "zoom in on ",
    ),
    (r"^camera on (?:the )?([\w ]+?), close\W*$", r"zoom in on the \1"),
    (r"^(?:photo|picture|pic|snap|shot|still) here(?: first)?, (?:then|and then) ", "take a picture, then "),
    (
        rf"\b((?:{_PICTURES})s?) of (?:the |that |this )?(?:(?:whole|entire|complete) [\w]+|sunset|sunrise|sky"
        rf"|landscape|scenery|skyline|panorama|view)\b",
        r"\1",
    ),
    (rf"^(?:please )?document (?:the|this) (?:current )?(?:view|scene|picture) with an? ({_PICTURES}|photograph)\b", r"take a \1"),
    (r"^for the next ([\w ]+? (?:seconds|minutes)), please ((?:follow|track)\b.*?)\W*$", r"\2 for \1"),
    (r"\bi (?:should|would|['’]d) (?:like|love|want) to see (the [\w ]+?) more closely\b", r"zoom in on \1"),
    (r"\bi (?:should|would) be (?:delighted|pleased|glad|happy|grateful) to have a closer look at ", "zoom in on "),
    (r"^eyes on (?=the |that )", "zoom in on "),
    (r"^(?:what|which) (?:places|presets|views|spots) has (?:this|the) camera got(?: saved| stored)?\b[^?.]*", "list the presets"),
    (
        rf"^(take (?:a|one) (?:{_PICTURES}|photograph)) before and after (pan|tilt|zoom|turn)(?:n)?ing (.+?)\W*$",
        r"\1, \2 \3, then \1",
    ),
    (r"^(?:could|may|can) i have (?=an? (?:photo|picture|snap|shot|still)\b)", "take "),
    (r"\b(get|bring) ((?:the|that) [\w ]+?) nice and close(?: for (?:me|us))?", r"zoom in on \2"),
    (
        r"^(?:an? )?(image|picture|photo|still|snapshot)(?: of (?:the )?(?:present|current) (?:view|scene))? "
        r"(?:required|needed|wanted)\W*$",
        r"take a \1",
    ),
    (rf"\b({_PICTURES}|photograph|image) of (?:the )?(?:present|current) (?:view|scene|frame)(?: first)?", r"\1"),
    (r"\bget (?:a )?close(?:r|-up)? (?:view|look|shot) (?:of|at) ", "zoom in on "),
    (r"\bget ((?:the|that) [\w ]+?) (?:nicely |right |properly )?in (?:the )?(?:frame|shot)\b", r"zoom in on \1"),
    (r"\b(?:give|get|show) (?:me|us) ((?:the|that) [\w'’ ]+?) in close[- ]?up\b", r"zoom in on \1"),
    (
        r"\bkeep (the [\w'’ -]+?) in (?:view|frame|shot|the picture) as (?:it|he|she|they) (?:moves?|goes?|walks?|drives?)\b",
        r"follow \1",
    ),
    (
        r"\b(track|follow) (?:the )?(?!it\b|him\b|her\b|them\b)([a-z][\w ]*?)\. (\d+) ?(s|secs?|seconds?|mins?|minutes?)\W*$",
        r"\1 the \2 for \3 \4",
    ),
    (
        r"^.*\bwhich (?:positions|presets|views|spots) (?:have been|are) (?:saved|stored)\b[^;.?]*[;.?] (?:so )?"
        r"(?:could|can|would|will) you "
        r"(?:please )?list them\b.*$",
        "list the presets",
    ),
    (rf",? (?:and )?take an? ({_PICTURES}) when (?:that|it)(?:['’]s| is) (?:finished|done|over)\b", r", then take a \1"),
    (
        r"\b(?:put|get) ((?:the|that) [\w ]+?) in (?:the )?(?:frame|shot)(?:, nice and (?:tight|close))?(?=\W*$|[,.;])",
        r"zoom in on \1",
    ),
    (r"\bi would appreciate a closer look at ", "zoom in on "),
    (r"\bget (?:me )?((?:the|that) [\w ]+?) in close\b", r"zoom in on \1"),
    (
        r"\b(?:bring|get|pull) (it|him|her|them) (?:up |in |right |nice and |really |very )*close(?: up)?(?=\W*$|[,.;]| then\b)",
        r"zoom in on \1",
    ),
    (r"^i want to see ((?:the|that) [\w'’ ]+?), bring it up close\W*$", r"zoom in on \1"),
    (r"\bmake ((?:the|that) [\w ]+?) fill the (?:picture|frame|view|screen)\b", r"zoom in on \1"),
    (r"^(?:i )?can['’]?t see (?:the )?([\w ]+?) anywhere, (find|locate) it(?: for me)?\W*$", r"find the \1"),
    (r"^where(?:['’]s| is) ((?:that|the) [\w ]+?) got to, find it\b[^.;]*$", r"find \1"),
    (r"\bwhat the camera is (?:looking|pointing) at(?: right now| now)?, it goes in (?:the|my) [\w ]+\W*$", "this"),
    (
        r"\b(?:pics?|photos|pictures) of (?:the )?([\w ]+?) and (?:the )?([\w ]+?)(?: pls| please)?, one each\W*$",
        r"take a picture of the \1 and of the \2",
    ),
    (
        r"^i (?:left|lost|dropped|forgot) (?:the|my) ([\w ]+?)(?: (?:somewhere|out|there|round|around)\b[^,.]*)?[,.] "
        r"(?:could you |can you |please )*find it(?: please| for me)?\W*$",
        r"find the \1",
    ),
)
"""Patterns with the words that replace them."""


def _inspected(match: re.Match[str]) -> str:
    """Return "zoom in on the hinge" for "I want to inspect the hinge"; after a move, such a wish is only its reason."""
    is_reason = not match["detail"] and _MOVED.search(match.string[: match.start()]) is not None
    return match[0] if is_reason else f"zoom in on {match['thing']}"

"""Patterns for moves, limits, views and pictures in the text of an instruction, with plainer words that mean the same."""

from __future__ import annotations

import re

_PICTURES = "photo|picture|pic|snap|shot|still"
_ENDS = {"lower": "down", "upper": "up", "left": "left", "right": "right"}
_TURNED = {
    "rotated": "rotate", "panned": "pan", "turned": "turn", "tilted": "tilt", "moved": "move", "zoomed": "zoom", "pointed": "point",
}  # fmt: skip
_GERUNDS = {
    "tak": "take", "zoom": "zoom", "go": "go", "mov": "move", "pan": "pan", "turn": "turn", "follow": "follow", "count": "count",
    "track": "track",
}  # fmt: skip
_DONE = {"counted": "count", "checked": "check", "taken": "take", "read": "read"}
_OPPOSITES = {"left": "right", "right": "left", "up": "down", "down": "up"}
_TENS = {"ten": 10, "five": 5, "twentie": 20, "fifteen": 15, "thirtie": 30}
_DIRECTIONS = "left|right|up|down"
_END = r"(?=\s*(?:[.,;!?]|$|and\b|then\b|please\b))"
_AS_FAR = (
    r"as (?:possible|(?:it|you|she|he|the camera)(?:['’]ll| will| can| could)?(?: ever| possibly)?"
    rf"(?: go(?:es)?| tilts?| pans?| turns?| moves?)?){_END}"
)
_TIME = r"(?:half an?|an?|\d+(?:\.\d+)?|[a-z]+(?:-[a-z]+)?)(?: and a half)? ?(?:s|secs?|seconds?|mins?|minutes?)(?: and a half)?"
_ABOUT = "(?:about|around|roughly|some|say|maybe|perhaps) "
_MAST = "tower|mast|roof|pole|camera|cam"

MOVES = (
    (
        r"\b(pan|tilt|turn|move|swing|go|rotate|zoom in|zoom out) (?:just )?(?:a little|a bit|slightly|a touch|a few degrees),? "
        rf"{_ABOUT}(\d+(?:\.\d+)?|\w+) (degrees?|deg|percent|%),? (?=(?:to the |up|down|left|right))",
        r"\1 \2 \3 ",
    ),
    (
        r"^(?:please )?(?:start|starting|begin|beginning) (?:off )?(?:from|at) (?:the |its |your )?home(?: position| view| preset)?"
        r"(?:,| and) (?=\w)",
        "go home, then ",
    ),
    (r"^(?:relative|incremental)(?: (?:move|movement|adjustment|step|command))?[:,.] (?=(?:pan|tilt|zoom)\b)", ""),
    (
        r"\b((?:a )?(?:half|third|quarter) of what) (?:(?:we|you|i)(?:['’]ve| have) got|(?:we|you|i) have|it(?:['’]s| is) at)"
        r"(?: right| at)?(?: now| present| the moment)?",
        r"\1 it is now",
    ),
    (r"\b(then|and|then,) (?:come|go|move) back (?=(?:by )?(?:\d|[a-z]+ degrees?\b))", r"\1 back "),
    (
        r"\b(?:i|we)(?:['’]d| would)? (?:need|want|like|have) to be "
        r"(?=(?:\d+(?:\.\d+)?|two|three|four|five|six) ?(?:x|times) (?:closer|nearer)\b)",
        "zoom in ",
    ),
    (
        r"\b(?:i|we)(?:['’]d| would)? (?:need|want|like|have) to be (?=(?:twice|three times|four times) as close\b)",
        "zoom in ",
    ),
    (r"\btighten (?:it |her )?up\b", "zoom in"),
    (r"\bgo to (?:whichever|whatever)(?: one)? (?:it|that) is\b", "go there"),
    (r"\b(left|right|up|down)\. \1(?= (?:by )?\d)", r"\1"),
    (r"\b(?:drive|run|steer) (?:the |this )?camera (?:over |back |across )?to\b", "go to"),
    (r"^(?:run|drive|come) (?:on |along |back )+home\b", "go home"),
    (r"\bbring (the|that|this) ([\w ]+?) into (?:a )?(?:close|closer|tight|full|better) view\b", r"zoom in on \1 \2"),
    (r"\bget ((?:the|that|this) [\w ]+?) nice and (?:big|large|close)\b", r"zoom in on \1"),
    (r"^home in on ", "zoom in on "),
    (r"(?<!left, )(?<!right, )(?<!up, )(?<!down, )(?<!steps: )\b(left|right|up|down), \1\b(?!,[^.;]*\b(?:each|apiece)\b)", r"\1"),
    (r"\bzoom (?:in )?(?:on to|onto) ", "zoom in on "),
    (r"\bclick (?=an? |one |the |some |two |three )", "take "),
    (r"\balter (?=the |your )", "change "),
    (r"\b(?:begin|commence) (?=(?:follow|track|trail|shadow)\w*ing\b)", "start "),
    (
        r"(?<!degrees )(?<!deg )\b(?:relative |incremental )?(pan|tilt)(?: (?:move|movement|adjustment|step))?[,:] (?:of |by )?"
        r"(?=(?:minus|plus|[-+]?\d))",
        r"\1 ",
    ),
    (
        r"^(?:very )?(?:fine|small|minor|slight|coarse) (?:adjustment|correction|tweak)[:,] (?:of )?"
        rf"(?=(?:\d|\w+ (?:deg|degrees?)\b|{_DIRECTIONS}|pan|tilt|zoom))",
        "",
    ),
    (
        r",? (?:executed|performed|done|made|carried out) (?:as|in) (?:one|a) "
        r"(?:single |combined |simultaneous |joint |continuous )*"
        r"(?:move|movement|motion|command|operation)\b",
        " in one move",
    ),
    (r"\b(closer|better|good|quick|little) peek\b", r"\1 look"),
    (r"^closer(?:,? please)?, a lot closer\b", "a lot closer"),
    (r"\bdegrees or so,? ", "degrees "),
    (r"\bby no more than (?=\w)", "by "),
    (r"\b(?:fully|completely) zoomed (in|out)\b", r"zoom all the way \1"),
    (r"^it should be zoomed (in|out) (\w+ percent)(?: more)?\b", r"zoom \1 \2"),
    (r"\breturn (?:it|the camera|the tilt) to level\b", "level the camera"),
    (rf",? duration:? (?=(?:{_TIME})\b)", " for "),
    (
        r"\b((?:follow|track|trail|tail|shadow|watch|stay|keep)\w*\b[^.;]*?),? (?:and |then )*(?:to )?"
        r"(?:continue|carry on|keep going|keep (?:it|that|this) up|keep at it|do (?:so|that))"
        rf"(?: (?:doing (?:so|that|it)|to do so|tracking|following))?,? (?=for (?:{_ABOUT})?(?:{_TIME})\b)",
        r"\1 ",
    ),
    (
        rf", (?:{_ABOUT})?({_TIME})(?: or so)? (?:ought to|should|will|would) (?:do|be)\b"
        rf"(?: (?:it|nicely|fine|enough|plenty|ample))*",
        r" for \1",
    ),
    (r"^i(?:['’]d| would) like the (?:image|picture|view) (\d+ ?%|\w+ percent) closer\b[^.;]*", r"zoom in \1"),
    (r",? (?:do )?(?:a )?full sweep all around\b", " all around"),
    (r"\bzoom right (in|out), max(?:imum)?\b", r"zoom all the way \1"),
    (r"\bback again by (?=the same|that)", "back by "),
    (r"\binspect (?=each|every|all the)", "go to "),
    (r"\ball the way (?:a)?round to the (left|right)\b", r"all the way to the \1"),
    (
        r"\b(?:(?:pull|go|come|move|take|bring)(?: it| her| the camera)? )?right (in|out) as (?:wide|far|tight|close) "
        r"as (?:it|she|he|you)(?:['’]ll| will| can)?(?: goes?| go)?\b",
        r"zoom all the way \1",
    ),
    (r"^.*\b(?:the same way|that way too|the same direction)\b.*$", lambda match: _same_direction(match[0])),
    (r"\b(as far as (?:it|she|he)(?:['’]ll| will)? go(?:es)?), all the way\b", r"\1"),
    (r",? so (?:that )?the (?:whole|entire) [\w ]+? (?:is|fits) in (?:the )?(?:picture|view|frame|shot)\W*$", ""),
    (
        r"\b(?:i (?:should|would) be (?:very )?grateful if )?the camera (?:could|can|should|may) be returned to "
        r"(?:its |the )?home(?: position)?",
        "go home",
    ),
    (r"^((?:look at|zoom in on)\b.*), get it nice and (?:close|tight)\W*$", r"\1"),
    (r"\bhave a (?:little |quick |wee )?look (?=which|what|how many|if|whether)", "tell me "),
    (r"^zoom (?:to )?max(?:imum)?(?=\W*$|,)", "zoom all the way in"),
    (r"\bzoom in, (?=(?:two|three|four|five|\d+) times closer)", "zoom in "),
    (r"^.*\bthe other way\b.*$", lambda match: _other_way(match[0])),
    (r"\b(?:ha|['’])?av a (good|quick|proper) look at\b", r"have a \1 look at"),
    (r"\bback it off\b", "zoom out"),
    (r"\bto plus (?=\d)", "to "),
    (r"^need it zoomed (in|out)\b", r"zoom \1"),
    (r"\bmax(?:imum)? zoom (in|out)\b", r"zoom all the way \1"),
    (r"(?<=\w), go\W*$", ""),
    (r"\b(left|right|up|down|in|out), (all the way(?: to the (?:stop|end|limit|edge))?)(?=\W*$)", r"\1 \2"),
    (
        r"^hard (left|right),? (?:all the way|(?:all the way |right )?to the (?:stop|end|limit|edge))(?=\W*$|[,.;])",
        r"all the way \1",
    ),
    (r"\bmake (?:it|her|the cam(?:era)?) (go|come|move|turn|look|point|swing|pan|tilt|zoom)(?= )", r"\1"),
    (
        r"\b(?:can|could|will|would) you (?:please )?(turn|spin|swing) (it|her|the cam(?:era)?) right a?round(?= so)",
        r"\1 \2 around",
    ),
    (r"\bzoom (in|out), (?:maximum|max|full)\b", r"zoom all the way \1"),
    (
        r"\bset the pan(?: angle)? to (\d+) degrees to the (left|right)\b",
        lambda match: f"set pan to {'-' if match[2].lower() == 'left' else ''}{match[1]} degrees",
    ),
    (r"^(?:last of all|finally|at the end),? ([^,.]+?), (?:but )?first ([^,.]+?)\W*$", r"first \2, then \1"),
    (r"^([^,.]+?),? but (count|take|check|go|pan|tilt|turn|zoom) ([^,.]+?) first\W*$", r"\2 \3, then \1"),
    (r"\b(more\b.*[?.] )go to the (?:busier|fuller) (?:one|of the two)\b", r"\1go there"),
    (r"\bturn clear a?round\b", "turn around"),
    (r"\b(\d+) ([1-7])/([2-8])\b", lambda match: f"{int(match[1]) + int(match[2]) / int(match[3]):g}"),
    (r"\bone quarter turn\b", "a quarter turn"),
    (r"\b(pan(?: the camera)? to [\w ]+?,? (?:and )?then )back to (?:zero|0)\b", r"\1pan to 0 degrees"),
    (r"\bcrank (?:it|her) (?:clear |right )(?:on )?(up|down)\b", r"tilt \1"),
    (r"\bback it out\b", "zoom out"),
    (r"^in to (?=\d)", "zoom in to "),
    (r"\b(?:mosey|amble|wander|trundle|scoot|jog) (?:on )?(?:over |down |up |along )?to ", "go to "),
    (r"^(?:(?:have|take) a )?gander at ", "have a look at "),
    (r"\b(?:leave|park|put) the camera (?:at|on) whichever(?: one)? has (?:more|the most)\b", "go there"),
    (r"\b(?:turn|spin|swing) (it |her |the camera )?right a?round(?! to)(?=,| please|\W*$)", "turn around"),
    (
        r"\b(?:swing|turn|spin) (?:it |her |the camera )?(?:right |all the way )?a?round(?: so(?: that)?| until| till) "
        r"(?:you['’]re|you are|it['’]?s|it is|we['’]re) (?:facing|looking|pointing) the other way",
        "turn around",
    ),
    (
        r"\bzoom (in|out) to (?:the|its) (?:maximum|fullest|full|greatest) (?:extent|amount|level|zoom)(?: "
        r"(?:available|possible))?",
        r"zoom all the way \1",
    ),
    (r"\bgo to the one (?:that['’]s got|that has|with|which has) (?:the )?(?:more|most)(?=\W*$|,)", "go there"),
    (r"\b(?:al the|all) way (?=up|down|left|right|in|out|round)", "all the way "),
    (r"\bnose (up|down)\b", r"tilt \1"),
    (r"(^|[,.;] |then |and )(?:then )?back to (\d+(?:\.\d+)?) ?(?:x|times)\b", r"\1zoom to \2x"),
    (r"\b(\d+) plus (?:another |a further |an extra )?(\d+)(?= degrees|\W*$)", lambda match: str(int(match[1]) + int(match[2]))),
    (r"\btilt to (\d+)(?: degrees)? below (?:the )?(?:horizontal|horizon)\b", r"tilt to minus \1 degrees"),
    (r"\b(?:point|aim|set)(?: the camera)? (?:at|to) (-?\d+)(?: degrees)? (pan|tilt)\b", r"set \2 to \1 degrees"),
    (r"\b(two|three|four|five|\d) time (?=bigger|closer|larger|wider|smaller)", r"\1 times "),
    (r"\bgo to whichever(?: one)?(?: it is| that is| has (?:it|more|the most)| wins?)?(?=\W*$|,)", "go there"),
    (
        r"(?<!left)(?<!right)(?<!up)(?<!down)(?<!in)(?<!out)(?<!wide)(?<!far)(?<!close)(?<!soon),? as (?:he|she|it|they) (?:goes?"
        r"|moves?|walks?|drives?|comes?)(?: along| past| by| around| through)?(?=[,.]|$| for )",
        "",
    ),
    (r"\bi (want|need) (?=see\b)", r"i \1 to "),
    (r"\b(?:in|by) (ten|five|twentie|fifteen|thirtie)s (?=until|till|til)", lambda match: _steps(match[1])),
    (
        rf"\b(?:i (?:should|would) be (?:very )?(?:grateful|glad|obliged) if )?the camera (?:shall|should|must|needs "
        rf"to|has to|could|can|may) be ({'|'.join(_TURNED)})\b",
        lambda match: _TURNED[match[1].lower()],
    ),
    (
        r"\b(?:(?:all the way|right|round|around|over) )*"
        r"to (?:the|its) (lower|upper|left|right)(?:most|[- ]hand)? "
        r"(?:mechanical |physical |end |hard )*(?:limit|stop|end of travel)\b",
        lambda match: f"all the way {_ENDS[match[1].lower()]}",
    ),
    (r"\b(?:go|come|move|pull) right (in|out)(?=[.,!;]|$| then\b| and\b)", r"zoom all the way \1"),
    (rf"\bas (?:far|high|low) (?:to the )?({_DIRECTIONS}) {_AS_FAR}", r"all the way \1"),
    (rf"\b(?:straight |right )?({_DIRECTIONS}),? as (?:far|high|low) {_AS_FAR}", r"all the way \1"),
    (rf"\b(?:all )?a?round (?:the (?:{_MAST})|you)(?=[.?!,]|$)", "all around"),
    (rf"\beverywhere (?:that )?you can see(?: from (?:the (?:{_MAST})|up there|there|where you are))?{_END}", "everywhere"),
    (
        r"((?:images|photos|pictures|stills|shots|snaps|pics)),? (?:in (?:direct|quick|immediate|rapid) succession|in a row"
        r"|one after (?:the other|another)|back to back|straight after each other)\b",
        r"\1",
    ),
    (r"\bmake (?:one|a) (?:single |combined |simultaneous )*move(?:ment)? of ", "move "),
    (
        r"\b(?:may|can|could|might) (?:i|we) (?:please )?have (?:the|this) (?:picture|view|image|shot) (?=[\w ]+? "
        r"times (?:closer|bigger"
        r"|larger)\b)",
        "zoom in ",
    ),
    (r"\bbring (?:the camera|it) (?:back |again |round )*to (?:its |the )?home\b", "go home"),
    (
        r"\bdon['’]?t be (tak|zoom|go|mov|pan|turn|follow|count|track)(?:k|m|n)?(?:e)?(?:in|ing)\b",
        lambda match: f"don't {_GERUNDS[match[1].lower()]}",
    ),
    (
        r"\b(?:drive|run|send|take|slew) (?:the |that )?(zoom|pan|tilt)(?: axis| motor| drive)? "
        r"(?=all|to|left|right|up|down|in|out|by|\d)",
        r"\1 ",
    ),
    (
        r"\b(?:can|could) (?:it|the camera|she) (?:please )?(go|come|move|turn|look|point|swing) (?=an?\b|to\b"
        r"|further|left|right|up|down|slightly)",
        r"\1 ",
    ),
    (r"\b(?:pull|go) (in|out) all the way(?: there)?\b", r"zoom all the way \1"),
    (r"\bzoom (?:max|full|fully) (in|out)\b", r"zoom all the way \1"),
    (r"\bzoom (?:to|at) (?:its |the )?(?:telephoto|tele|narrow|long) (?:limit|end|stop)\b", "zoom all the way in"),
    (r"\bzoom (?:to|at) (?:its |the )?(?:wide|wide[- ]angle|short) (?:limit|end|stop)\b", "zoom all the way out"),
    (r"\bput it back (?:to )?where it (?:normally |usually )?(?:sits|lives|belongs|goes|points|looks)\b", "go home"),
    (r"\b(every (?:preset|view|position|spot)) there\b", r"\1"),
    (r"\beach preset: (?:1[.)] )?go to (?:the|that|each) preset[;,.] (?:2[.)] )?(?:then |and )?", "each preset, "),
    (r"\bswing (?:it )?over to the (left|right) by\b", r"pan \1 by"),
    (r"\bgo back to 0\b", "pan to 0 degrees"),
    (r"\bpoint at (-?\d+) degrees(?= ?, then pan to)", r"pan to \1 degrees"),
    (r"\bmake it double zoom\b", "double the zoom"),
    (r"\b(?:the )?present (view|frame|picture|image|shot)\b", r"the current \1"),
    (r", ((?:\d+|[a-z]+|half a|a) (?:minutes?|seconds)) (?:is|are|will be) (?:enough|plenty|fine)\W*$", r" for \1"),
    (r"(?<=\w) see where (?:he|she|it|they) (?:goes|go)\b[^,.;]*\W*$", ""),
    (
        r"\b(pan|tilt)( the camera)? to ([+-]?\d+)(?: degrees)?,? (?:and )?then to ([+-]?\d+)(?: degrees)?",
        lambda match: f"{match[1]} to {match[3].lstrip('+')} degrees, then {match[1]} to {match[4].lstrip('+')} degrees",
    ),
    (r"^last of all,? ([^;.]+)[;.] (?:start|begin) with (.+?)\W*$", r"\2, then \1"),
    (r"^(?:see|check) (?:if|whether) (the [\w ]+?) is (\w+ing) and if (?:it is|so),? ", r"if \1 is \2, "),
    (r" should (?:just )?(?:about )?do (?:it|nicely)\W*$", ""),
    (r"\bnip it (up|down|left|right)\b", r"move it \1"),
    (
        r"\b(?:point|aim)(?: the camera)? at (-?\d+) degrees,? (?:and )?then at (-?\d+) degrees",
        r"pan to \1 degrees, then pan to \2 degrees",
    ),
    (
        r"^((?:pan|tilt|turn) (?:up|down|left|right))[.,] not (?:much|far|a lot)[,:] ([\w -]+? degrees)(?: will do| "
        r"is enough| should do)?\W*$",
        r"\1 \2",
    ),
    (r", (?:and )?i mean (a lot|all the way|a bit)\W*$", r" \1"),
    (r"\b(?:put it|go|come|bring it) (?:back|down|up) to (\d+(?:\.\d+)?) ?x\b", r"zoom to \1x"),
    (r"^as (?:wide|far out) as (?:she|it|he) goes\W*$", "zoom all the way out"),
    (r"\bgo as wide as (?:you can|it goes|possible)\b", "zoom all the way out"),
    (
        r"\b(?:bring|take|tilt) it (?:right )?(down|up) (?:till|until) it (?:won['’]?t|will not) go any (?:lower|higher|further)\b",
        r"tilt all the way \1",
    ),
    (r"\bbring the (?:picture|image|view) in by ", "zoom in by "),
    (r"\b(pan|tilt)( the camera)? to (\d+) degrees,? (?:and )?then to minus (\d+)\b", r"\1 to \3 degrees, then \1 to -\4 degrees"),
    (r"\bcan we bring it (up|down|left|right)\b", r"move it \1"),
)
"""Patterns with their replacements: words, or a function of the match."""


def _same_direction(text: str) -> str:
    """Return "right 10, then 20 degrees to the right" for "right 10, then a further 20 degrees in the same direction"."""
    named = re.findall(rf"\b(?:{_DIRECTIONS})\b", text, re.IGNORECASE)
    if len(named) != 1:
        return text
    return re.sub(
        r"(?:a further |another )?([\w-]+)(?: degrees)? (?:in the same direction|the same way|that way too)\b",
        rf"\1 degrees to the {named[0]}",
        text,
        flags=re.IGNORECASE,
    )


def _other_way(text: str) -> str:
    """Return "right 60, then left 15 degrees" for "right 60, then back 15 the other way"."""
    named = re.findall(rf"\b(?:{_DIRECTIONS})\b", text, re.IGNORECASE)
    if len(named) != 1:
        return text
    opposite = _OPPOSITES[named[0].lower()]
    return re.sub(r"(?:back )?(\d+)(?: degrees)? the other way\b", rf"{opposite} \1 degrees", text, flags=re.IGNORECASE)


def _steps(word: str) -> str:
    return f"{_TENS[word.lower()]} degrees at a time "

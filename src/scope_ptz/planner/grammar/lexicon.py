"""The words of camera operation: which phrases make which terminal of ``language.lark``.

A phrase pattern is plain words with ``(a|b)`` for a choice and ``[a|b]`` for an optional one; hyphens count as spaces.
Longer phrases win over shorter ones. A leading ``~`` stands for every form of the verb that follows it (pan, pans, panning).
"""

from __future__ import annotations

import re
from functools import cache

_WHOLE = "(the whole|the entire|the full|the complete|all of the|whole|entire|all of this|this whole|this entire|the overall)"
_AREA = "(scene|area|site|place|surroundings|environment|location|panorama|sweep|compound|premises|field of regard|neighbourhood|worksite)"
_PHOTO = "(picture|photo|photograph|snapshot|image|screenshot|shot|still|frame|pic|snap|capture|screen capture|screen shot)"
_PHOTOS = "(pictures|photos|photographs|snapshots|images|screenshots|shots|stills|pics|snaps)"
_AS_FAR = "as far as (it goes|it will go|possible|you can|it can|it can go|you can go|it ll go)"

PATTERNS: dict[str, tuple[str, ...]] = {
    # Glue
    "THEN": (
        "[and] then", "[and] (after that|after this|afterwards|afterward|thereafter|subsequently)", "[and] next", "followed by",
        "after which", "[and] (when|once) (done|finished|that is done|you are done|that s done|you re done|you are there|you re there|you get there)",
        "[and] finally", "[and] lastly", "[and] last of all", "after you are done", "[and] then after that", "[and] as (a next|the next) step",
        "upon arrival", "on arrival", "second of all",
    ),
    "AND": ("and", "as well as", "plus", "and also", "while also", "together with", "whilst", "along with", "but", "and (at the same time|simultaneously)", "at the same time"),
    "OR": ("or", "versus", "vs", "rather than", "or rather"),
    "THAN": ("than", "than there are", "compared to", "compared with", "than there are of"),
    "IF": (
        "should", "if", "when", "whenever", "once", "as soon as", "in case", "provided [that]", "only if", "in the event [that]",
        "the moment [that]", "assuming [that]", "so long as", "supposing", "as long as", "whether",
    ),
    "IFSO": ("if (so|yes|there is one|it does|that is the case|that s the case)", "if the answer is yes"),
    "UNLESS": ("unless", "if not for"),
    "OTHERWISE": ("otherwise", "[or] else", "if not", "but otherwise", "or otherwise", "if that fails", "if there are none", "if there is none", "if none", "and if not", "and if there are none", "if not then"),
    "UNTIL": (
        "until", "till", "til", "untill", "unitl", "[and] stop (when|once|as soon as|if)", "stopping (when|once|as soon as|if)",
        "[and] (halt|pause) (when|once|as soon as)", "up to the point where", "to the point where", "only stop when", "unti", "untl", "or until",
    ),
    "WHILE": ("while", "as long as", "for as long as"),
    "BEFORE": ("before [you]", "prior to", "but before [you]"),
    "AFTER": ("after [you]", "after (you have|having|you ve)"),
    "EACHTIME": (
        "(each|every) time", "after (each|every) (one|step|move|pan|turn|tilt|zoom|stop|increment)", "at (each|every) (step|stop|one|of them|move|increment|position|point|place|location)",
        "at each", "on (each|every) (step|stop)", "(each|every) step", "from (each|every|each one|each of them)", "in each [one]", "between (moves|steps)", "in between",
        "for (each|each one|each of them)", "(each|every) step of the way", "along the way", "there each time", "at both", "in both", "at each of (them|these|those)", "as you go", "after each", "from both",
    ),
    "KEEP": ("keep", "keep on", "continue", "continue to", "carry on", "go on", "proceed to", "continuously", "again and again", "over and over [again]", "one step at a time", "bit by bit", "little by little", "step after step", "repeatedly", "incrementally", "gradually", "progressively", "step by step"),
    "NOT": ("(do not|don t|dont|never|without|no|avoid|stop|you should not|must not|you don t need to|there is no need to|no need to|refrain from|instead of|don t you|do not ever|not)",),
    "INSTEAD": ("instead",),
    # Asking
    "HOWMANY": ("how many", "how many of the", "how many of", "what number of", "how many total", "how many different", "how many are there of", "howmany", "how mny"),
    "HOWMANYMORE": ("how many (more|fewer|extra|additional|less)",),
    "COUNT": ("~count", "~tally", "~number up", "~enumerate", "~count up", "do a count of", "do a (headcount|head count) of", "~tot up", "give a count of", "take a count of", "get a count of", "make a count of", "get me a count of", "coutn", "cuont", "conut"),
    "NUMBEROF": ("[the] [total] (number|count|amount|quantity|tally) of", "[the] total of", "a count of", "a tally of", "the (total|exact|overall) (number|count) of", "a (headcount|head count) of"),
    "COMPARE": ("~compare", "make a comparison of", "~contrast"),
    "WHAT": ("what", "what s", "what re", "whats", "what kind of", "what type of", "what sort of"),
    "WHICH": ("which", "which of", "which one", "which one of", "whichever", "whichever one", "whichever of", "whichever one of", "wherever", "in which", "at which", "from which", "on which", "which ones", "at what", "from what"),
    "WHO": ("anyone", "anybody", "anything", "someone", "somebody", "something", "nobody", "who", "who s", "whose", "whom", "where", "where s", "wheres", "when is", "why", "how", "how s", "how come"),
    "THEREBE": (
        "(is|are|was|were) there [still]", "there (is|are|was|were)", "there s", "there re", "there (happens|happen|seem|seems|appear|appears) to be", "there be", "does there exist", "there exists", "there will be", "we have", "you have", "you ve got", "we ve got", "you get", "there are still", "there is still",
    ),
    "THERENOT": ("there (is|are) not", "there (isn t|aren t|wasn t|weren t)", "(isn t|aren t) there"),
    "NOTSEE": ("(you|we|i|the camera|it) (don t|do not|can t|cannot|can not|no longer|can no longer) (see|spot|find|detect)", "(don t|do not|can t|cannot) see"),
    "BE": ("s", "is", "are", "was", "were", "be", "being", "isn t", "aren t", "has been", "have been", "becomes", "become", "gets", "looks", "has", "have"),
    "DO": ("do", "does", "did", "doesn t", "don t", "didn t"),
    "YOUSEE": (
        "(do|can|could|did) (you|we|i|the camera) [now|still|currently] (see|spot|detect|make out|notice|observe)", "do (you|we|i) find", "[that] (you|we|i|the camera|it) [now|still|currently|actually|finally|first|can|can now|do|re able to|are able to|have|ve|can finally] (see|sees|spot|spots|detect|detects|find|finds|make out|notice|count|counts|observe|identify|got|found|seen|spotted|counted)",
        "~see", "~spot", "~detect", "~notice", "~observe", "does (it|the camera) see", "(will|would) (you|i|we|the camera) see", "can be seen", "~identify",
    ),
    "YOUREAD": ("(you|we|i|it) (can|could|are able to|re able to|can now|can finally|can clearly|can actually) [clearly] read", "(can|could) (you|we|i|it) read"),
    "READABLE": ("(is|are|becomes|become|gets) [clearly|easily|fully] (readable|legible|readible)", "can be [clearly] read", "(is|are|becomes) (clear|big|large) enough to read", "(readable|legible)"),
    "VISIBLE": (
        "[that] (is|are|was|were|becomes|become|get|gets) [clearly|still|currently|now] (visible|in view|in sight|in the view|in frame|in the frame|on screen|in shot|present|there|found|spotted|detected|seen|showing|in the picture|in the image)",
        "(appear|appears|appeared)", "(shows|turns|pops) up", "(come|comes|came) (into|in) (view|sight|frame|the frame|the picture|shot)", "(enter|enters) [the] (view|frame|picture|scene|shot)",
        "(can|could) be [seen|spotted|found|counted|detected]", "can (you|we|i|the camera) (see|spot|make out|detect)", "do (you|we|i) (see|spot|count|have|find)", "does the camera see", "visible", 
        "you can see", "you see", "are there", "is there", "there are", "in sight", "that you can see", "you can count", "you can find", "are shown", "exist", "exists", "remain", "remains", "are (left|left over|remaining)", "are we seeing", "are you seeing",
    ),
    "GONE": (
        "(disappear|disappears|vanish|vanishes|leave|leaves|left) [the (view|frame|scene|picture)]", "(is|are) (gone|out of view|out of sight|out of frame|no longer visible|not visible|no longer there|no longer in view|not in view|absent|not there)",
        "(isn t|aren t) (visible|there|in view|any more|anymore)", "goes out of (view|frame)", "(leave|leaves) the (view|frame)",
    ),
    "ANYMORE": ("any more", "anymore", "any longer", "no longer"),
    "TELL": (
        "~tell me", "let me know", "~report [back]", "~inform me", "i (want|need|would like|d like|wish) to know", "find out", "work out", "figure out", "~tell us", "~say", "~check", "~verify", "~confirm", "~determine", "make sure", "see (if|whether)", "~tell", "~answer", "~state",
        "~estimate", "~assess", "~establish", "i wonder", "do you know", "report to me", "have a look and tell me", "look and tell me", "take a look and tell me", "~check and tell me", "~work out", "~report on", "i am wondering", "i m wondering", "i m curious",
    ),
    "SAYSO": ("say so", "(tell|alert|notify|warn) me [so|about it|that]", "let me know [so]", "report (it|that|so)", "tell us", "raise the alarm", "sound the alarm"),
    "DESCRIBE": ("~describe", "~summarise", "~summarize", "~explain", "give [me] a description of", "~caption", "~list", "give me an overview of", "give [me] a summary of", ),
    "READ": ("~read", "~read out", "~read me", "~read off", "~transcribe", "~read aloud", "read out loud", "~ocr", "~read to me", "~decipher"),
    "SAYS": ("says", "say", "reads", "read", "shows", "is written"),
    # Camera motion
    "PAN": ("~pan", "~turn", "~swing", "~rotate", "~swivel", "~slew", "~pivot", "~spin", "~yaw", "~veer", "~track over", "(make|do|perform|complete|give) [a|an|one]", "~traverse"),
    "TILT": ("~tilt", "~pitch", "~incline", "~angle"),
    "LOOK": ("(have|take) a [quick] (look|peek|glance)", "~look", "~aim", "~point", "~face", "~gaze", "~peer", "~direct", "~orient", "~train"),
    "MOVE": ("~move", "~go", "~shift", "~nudge", "~adjust", "~bring", "~jog", "~slide", "~head", "~steer", "~reposition", "~get", "~proceed", "~bump", "~step", "~scoot", "~ease", "~continue"),
    "SWITCH": (
        "~switch [over]", "~change [over]", "~jump", "~cut", "~load", "~recall", "~call up", "~select", "~open", "~activate", "~use", "~visit", "take me", "~return", "~revert", "bring up", "pull up", "~go back", "~come back", "~move back", "take us", "~go over", "~head over", "~get back", "~move over", "~choose", "~pick", "~swing over", "~navigate", "~travel", "~snap over", "switch back", "~go straight", "~turn back", "~swing back", "~pan back", "~hop",
    ),
    "SET": ("~set", "~put", "~make", "~change", "~fix"),
    "SWEEP": (
        "~sweep", "~scan", "~survey", "(do|perform|make|run|carry out|complete) a [full|complete|360|360 degree|whole|panoramic] (sweep|scan|survey|panorama|look around)", "look [all|right] around", "~search", "~pan around", "check [the] (everywhere|all around)", "take a look around", "have a look around",
        "look everywhere", "look in (all directions|every direction|each direction)", "~patrol", "~explore", "(do|with|by|using|make) a 360 [degree turn|degrees|degree spin]",
    ),
    "SURROUND": (f"{_WHOLE} {_AREA}", "the (scene|area|site|place|surroundings|environment|horizon|panorama|location|surrounding area)", "everything", "everywhere", "all around [you]", "around", "(all|in all) directions", "all 360 degrees", "the full 360 [degrees]", "your surroundings", "in every direction"),
    "LEFT": ("left", "to the left", "leftward", "leftwards", "to your left", "to its left", "towards the left", "toward the left", "counterclockwise", "counter clockwise", "anticlockwise", "anti clockwise", "left hand", "to the left hand side", "to the left side", "over to the left", "ccw", "lefts", "westward"),
    "RIGHT": ("right", "to the right", "rightward", "rightwards", "to your right", "to its right", "towards the right", "toward the right", "clockwise", "right hand", "to the right hand side", "to the right side", "over to the right", "cw", "rigth"),
    "UP": ("up", "upward", "upwards", "higher", "higher up", "raise", "raising", "lift", "lifting", "skywards", "towards the sky", "toward the sky", "elevate", "elevating", "above [the] (horizon|horizontal|level)"),
    "DOWN": ("down", "downward", "downwards", "lower", "lowering", "lower down", "towards the ground", "toward the ground", "dip", "dipping", "drop", "dropping", "below [the] (horizon|horizontal|level)"),
    "UPLEFT": ("(up|upper|upwards) left", "diagonally (up|upwards) [and|to the] left", "left up", "to the (upper|top) left", "to the upper left corner"),
    "UPRIGHT": ("(up|upper|upwards) right", "diagonally (up|upwards) [and|to the] right", "right up", "to the (upper|top) right"),
    "DOWNLEFT": ("(down|downwards) left", "diagonally (down|downwards) [and|to the] left", "left down", "to the (lower|bottom) left"),
    "DOWNRIGHT": ("(down|downwards) right", "diagonally (down|downwards) [and|to the] right", "right down", "to the (lower|bottom) right"),
    "DIAGONALLY": ("diagonally",),
    "AROUND": ("around", "round", "right round", "right around", "back around", "to face the other way", "to the other side", "to face backwards", "to face behind you"),
    "TURNAROUND": ("turn (around|round)", "about face", "face the other way", "face (backwards|behind you|the back|the opposite direction|the opposite way)", "look (behind|behind you|backwards)", "(do|make) (an about face|a u turn|a 180)", "turn back around", "turn to face (backwards|the other way|behind you)", "look the other way", "do a 180", "spin around", "u turn", "turning around"),
    "CIRCLE": ("turn", "circle", "rotation", "revolution", "turns", "spin", "sweep", "circles", "rotations"),
    "FULL": ("full", "complete", "whole", "entire"),
    "FULLTURN": ("[a|one|the] (full|complete|whole|entire) (turn|circle|rotation|revolution|360|spin|loop|circuit|sweep around)", "[the] way (around|round)", "all the way around", "all the way round", "right the way round", "a full 360", "[the] full way around", "through a full circle", "in a full circle"),
    "RIGHTANGLE": ("[a] right angle", "[by|through] a right angle"),
    "LITTLE": ("[just|by|only] (a bit|a little|a little bit|a touch|a tad|a hair|a smidge|a fraction|a wee bit|a tiny bit|a small amount|a smidgen|a notch|a shade|a nudge|one notch|a small bit|just a bit|a few degrees|a couple of degrees)", "slightly", "little bit", "bit", "marginally", "a bit of", "ever so slightly", "a little way", "some", "a teeny bit"),
    "LOT": ("[by] (a lot|a great deal|a long way|a good bit|a good deal|a fair bit|lots|loads|quite a bit|quite a lot|a large amount|plenty)", "far", "way", "much", "much further", "much more", "sharply", "significantly", "considerably", "hard", "substantially", "strongly"),
    "MORE": ("more", "further", "farther", "another", "an additional", "additional", "some more", "extra", "an extra", "a further", "again", "once more", "even more", "even", "one more time", "yet another", "additional"),
    "LIMIT": ("all the way", "fully", "completely", "totally", "entirely", "[up] to the (limit|stop|end|maximum|end stop|edge|extreme|very end)", "to (its|your) (limit|stop|maximum|furthest point)", "[to|at] the (far|extreme|furthest)", _AS_FAR, "as much as (possible|you can)", "to the max", "right to the (stop|end)", "hard over", "to maximum", "to the very (end|top|bottom|edge)", "as (high|low) as (possible|you can|it goes|it will go)", "to (max|full)", "[until] it stops", "right over", "maximally", "until it (stops|can t go any further)", "until you can t go any further", "until you (hit|reach) the (limit|end|stop)", "until the (limit|end|stop)"),
    "ASFARAS": ("as far", "as far to the", "as far over to the"),
    "POSSIBLE": ("as (it goes|it will go|possible|you can|it can|it can go|you can go|it ll go)",),
    "DEG": ("degrees", "degree", "deg", "degs", "degress", "degres", "°", "dgrees", "degreees"),
    "STEPS": ("(step|steps|increment|increments|jumps|stages|intervals|hops|chunks|notches|moves)",),
    "STEPSOF": ("[in|by|using|with|at] (steps|increments|jumps|stages|intervals|hops|chunks) of",),
    "ATATIME": ("at a time", "per step", "each", "per move", "at each step", "by each step"),
    "TO": ("to", "towards", "toward", "into", "onto", "over to", "on to", "back to"),
    "BY": ("by", "through", "about", "roughly", "around", "approximately", "some", "for", "of", "exactly", "by about", "by around", "by roughly", "by exactly", "by approximately", "by another", "for about", "by a further", "by an additional", "a total of", "circa", "or so"),
    "CAMERA": ("[the|your|this] (camera|cam|lens|ptz|camera head|camera view|head|device|ptz camera)", "[the|your|this] (view|viewpoint|field of view|shot|frame|picture|image|gaze|line of sight)", "yourself"),
    "PANNOUN": ("[the|your] (pan|azimuth|heading|bearing|yaw) [angle|position|value|axis]",),
    "TILTNOUN": ("[the|your] (tilt|elevation|pitch) [angle|position|value|axis]",),
    "ZOOMNOUN": ("[the|your] (zoom|magnification) (level|factor|value|setting)", "the (zoom|magnification)", "magnification", "your zoom", "zoom level"),
    "AHEAD": ("straight [ahead|forward|on]", "[dead|directly|right] ahead", "forward", "forwards", "[to|towards] the front", "[to|in] the (forward|straight) [ahead] (direction|position)", "front", "due ahead", "straight in front [of you]"),
    "LEVEL": ("~level [off|out] [with the horizon]", "[at|to|towards] the horizon", "horizontal", "horizontally", "to horizontal", "to level", "[the] horizon", "level with the horizon", "to eye level"),
    "CENTREUP": ("(centre|center|recentre|recenter|centering|straighten) [up|out]",),
    "STRAIGHTDOWN": ("straight down", "directly down", "right at the ground", "vertically down", "straight downwards", "directly below [you]"),
    "STRAIGHTUP": ("straight up", "directly up", "vertically up", "straight upwards", "directly above [you]"),
    "COMPASS": ("(north|south|east|west|northeast|northwest|southeast|southwest)",),
    # Zoom
    "ZOOM": ("~zoom", "~magnify", "zom", "zooom", "zoon"),
    "IN": ("in", "inwards", "inward"),
    "OUT": ("out", "outwards", "outward", "back out", "away"),
    "CLOSER": ("[~get|~go|~move|~come|~look|~step] [in] (closer|nearer|tighter)", "(closer|nearer|tighter|narrower)", "~tighten [up]", "~narrow", "~enlarge", "tighter on", "close in", "punch in", "push in"),
    "WIDER": ("[~get|~go|~move|~look] (wider|further out)", "~widen", "pull (back|out)", "back (off|out|away)", "wider", "zoom back", "~broaden", "zoom back out", "go wide", "pulling back"),
    "FIELD": ("[the|your] (angle|field|field of view|fov|view|shot|lens|angle of view|zoom|magnification|framing)",),
    "X": ("x", "×", "fold", "ex"),
    "TIMES": ("(times|time) [over|in a row|in total|in succession|in all]", "(tries|attempts|goes|rounds|iterations|repeats|repetitions)", "consecutive times",),
    "ONCE": ("once", "one time", "a single time", "just once"),
    "TWICE": ("twice", "two times", "thrice", "a couple of times", "a few times"),
    "PERCENT": ("%", "percent", "per cent", "pct"),
    "FACTOROF": ("[by|with] a factor of", "factor", "by factor"),
    "DOUBLE": ("~double", "~triple", "~quadruple"),
    "HALVE": ("~halve", "~half"),
    "TWICEAS": ("twice as", "two times as", "double as", "twice the", "three times as", "four times as", "thrice as"),
    "HALFAS": ("half as", "half the"),
    "CLOSE": ("(close|near|large|big|tight|magnification|zoom|narrow|detailed|zoomed in)",),
    "WIDE": ("(wide|far out|broad|width|field of view|zoomed out|angle|view)",),
    "ZOOMMAX": ("(max|maximum|full|highest|greatest|fullest|most) (zoom|magnification|telephoto)", "[to] (full|max|maximum) tele [photo]", "as close as (possible|you can|it goes)", "zoom to the (max|maximum)", "full telephoto", "the maximum"),
    "ZOOMMIN": ("[to|go|set|use] [the|its] (widest|full wide|widest angle|widest view|widest shot|widest zoom|full wide angle|wide angle|minimum zoom|min zoom|lowest zoom|no zoom|smallest zoom|1x zoom)", "~reset [the] zoom", "reset [the] (zoom level|magnification)", "as wide as (possible|you can|it goes)", "undo the zoom", "unzoom", "un zoom", "wide open", "[show me] (a|the) (wide|wider|widest) (view|shot|angle|picture)", "show me everything", "so [that] you see everything", "(to see|see) everything", "[show me] the (big picture|bigger picture|overview)", "cancel the zoom", "clear the zoom", "back to (wide|1x|normal zoom)", "remove the zoom"),
    # Things
    "LOOKAT": (
        "~zoom in (on|onto|into|towards|at)", "~zoom (on|onto|into|towards)", "~zoom on to", "~zoom right in on", "~focus [in] [on|onto|upon]", "~look [closely|closer|carefully] (at|towards|toward)", "(take|have|get) a [good|closer|close|quick|better|proper] (look|view) (at|of)",
        "~centre (on|in on|around|onto)", "~center (on|in on|around|onto)", "~frame", "~close in on", "~home in on", "~hone in on", "~get closer to", "~move in on", "~get a closer view of", "~go closer to", "(get|give me) a (close up|closeup) (of|on)", "close up (of|on)", "~inspect", "~examine",
        "~frame up", "~point at", "~aim at", "~aim for", "point (the camera|it|the lens|yourself) (at|to|towards|toward)", "(aim|train|turn|direct|swing|orient|rotate|focus) (the camera|the lens|it|the view) (at|to|toward|towards|on|onto)", "~concentrate on", "~enlarge", "~zoom tight on", "~zoom close to", "~move closer to", "~come closer to", "~zoom in close on", "~magnify",
        "~zero in on", "~push in on", "punch in on", "(put|place|get|bring|centre|center) the camera on", "~show a (close up|closer view) of", "i (want|need|would like|d like) a (closer look at|close up of|better look at|closer view of)", "~look over at", "~look towards", "turn towards", "~zoom all the way in on", "~zoom fully in on", "~zoom in as far as possible on", "~take a peek at",
    ),
    "CENTRE": ("~centre", "~center"),
    "FIND": ("~find", "~locate", "~look for", "~search for", "~seek", "~spot", "~hunt for", "~find me", "~seek out", "~pick out", "~pinpoint", "~detect", "~track down", "~look out for", "~watch [out] for", "~keep an eye out for"),
    "SHOW": ("~show [me|us]", "let (me|us) see", "i (want|need|would like|d like|wanna) to (see|look at)", "~display", "~present", "put up", "get me", "bring me", "i wanna see", "have a look at", "i want to look at"),
    "GIVE": ("~give (me|us)", "~provide [me] [with]", "i (want|need|would like|d like)", "~get (me|us)"),
    "TRACK": ("~track", "~follow", "~keep (an eye|watch|eyes|your eye|a close eye) on", "~stay (on|with)", "~lock on[to]", "~lock onto", "~lock on", "~lock on to", "~shadow", "~watch", "~keep tracking", "~keep following", "~monitor", "~trail", "~keep up with", "~keep track of", "start (tracking|following)", "~tail", "~keep the camera on", "keep looking at", "keep with"),
    "KEEPX": ("keep", "keeping", "hold", "holding", "maintain"),
    "INVIEW": ("into (view|frame|shot|the frame|the middle|the centre|the center|the middle of the frame|the centre of the frame|the center of the frame|focus|the picture)", "in (view|frame|shot|the frame|focus|sight|the picture|the middle|the centre|the center|the middle of the frame|the centre of the frame|the middle of the view)", "centred", "centered", "in the (middle|centre|center) of the (view|picture|frame|image|screen)", "on screen"),
    "FOR": ("for", "for the next", "for about", "for at least", "for around", "for up to", "during", "over the next", "for a period of", "for exactly", "for a full", "for a"),
    "SECONDS": ("(second|seconds|sec|secs|s)",),
    "MINUTES": ("(minute|minutes|min|mins|m)",),
    "HOURS": ("(hour|hours|hr|hrs)",),
    "TAKE": ("~take", "~snap", "~grab", "~save", "~capture", "~shoot", "~get", "~make", "~record", "~store", "~snag", "i (want|need|would like|d like)", "~give me", "with", "~click", "~acquire"),
    "PICTURE": (f"[a|an|one|another|a new|the|a quick|me a|a second|a third|a final|one more|one last|a last|yet another|a single|one final|a further] {_PHOTO}", f"{_PHOTOS}", "a (photo|picture) or two"),
    "SNAP": ("~capture", "~snap", f"~{'photograph'}", "screenshot", "~capture (the|this|that|what you) (view|scene|frame|image|picture|moment|see)", "~snapshot", "take (one|it|another|another one|a second one)", "another one", "capture (this|that|it)", "snap (this|that|it)", "~save (the|this) (view|scene|frame|image|picture)", "~grab (the|this) (view|scene|frame)", "say cheese", "take (a screenshot|a screen grab|a screengrab)", "screen grab", "screengrab"),
    "OFVIEW": ("of (the|this|that|your|the current|the present|my) (view|scene|frame|picture|image|current view|area|screen)", "of (this|that|it all|everything|what you see|what you can see|it)", "of what is (visible|in view)", "of what (you are|you re|the camera is) (looking at|seeing|pointing at|viewing)", "of what (you|the camera) (see|sees)", "there", "here", "from here", "from there", "of here", "of there"),
    # Places
    "HOME": (
        "[~go|~return|~head|~move|~come|~drive|~get|~take the camera|~fly] [back] [to] [the|your] home [position|view|preset|pose|place|location|base]", "reset [the] (camera|view|position|ptz|everything|pose)", "reset", "(go|return|move|get) back to (the default|default|the original|the initial|the home) (view|position)", "[~go|~return|~move|~switch] [back] to [the|its|your] (default|home|initial|starting) (view|position|pose|orientation)", "go to home", "home", "homing", "[go|return|head] [back] to base", "reset [back] to [the] home [position|view]", "reset home", "re home", "return the camera home", "bring the camera [back] home", "move the camera [back] home", "park the camera", "send the camera home", "take the camera [back] home", "switch to home", "switch to the home (preset|view)", "return the camera to [the|its] home [position|view]",
    ),
    "PRESETWORD": ("(preset|presets|bookmark|view|position|preset view|preset position|camera position|viewpoint|camera view|spot|scene preset|preset location)",),
    "PRESETS": (
        "[the|your|all|all the|any|all available|the available|all of the|available|the camera|saved|the saved|my|our|camera|the stored|stored] (presets|preset views|preset positions|preset names|bookmarks|saved views|saved positions|stored positions|preset list|list of presets)",
    ),
    "EVERYPRESET": ("[at|in|from|for|to|of] (each|every|all|all the|all of the|every single|both|each of the|every one of the|all available|both of the|all your|all our|each available|both the|all three|all four|all five|all six|the available|these) (preset|presets|view|views|position|positions|preset positions|preset views|bookmark|bookmarks)", "[at|in|from|for] the (presets|views)", "each and every preset", "the presets one by one", "(them|the presets) all"),
    "EACHOF": ("(at|in|from|for) both [the]", "[in|at|from|for|to|of] (each of|every one of|both of|both the|all of)",  "both [of]", "all of", "each of the (presets|views|following|two presets|positions)", "the presets", "presets", "both presets", "the two presets", "each of the following", "the views", "both the", "either"),
    "PREVIOUS": ("[the|that|its] last (position|view|place|pose|spot|location|orientation|direction)", "[the|that|its] (previous|former|original|earlier|prior|old|starting|start|initial) (preset|position|view|place|pose|spot|location|orientation|direction|setting|zoom|zoom level|point)", "[to] where (you|it|we) (were|was|started|began|came from|had been|are now)", "the way you came", "where you started from", "the start", "its start", "as (it|you) (was|were)"),
    "THERE": ("there", "that preset", "that one", "that view", "that position", "the winner", "the winning (one|preset|view)", "that place", "the one with more", "the busier (one|preset|view)"),
    "BACK": (
        "[~come|~go|~return|~turn|~move|~get|~swing|~head|~pan|~tilt|~rotate|~step] back [again]", "~return", "undo [that|it|the move|the last move|this]", "~come back", "[~go|~come|~turn] back the other way", "[~go|~come|~move] back by the same amount", "~reverse [that|it|the move]", "~go back again", "revert", "back", "put it back", "back again", "undo the (last|previous) (move|movement|command)", "bring it back", "move it back", "take that back", "~come back [again]", "return again", "undo", "undo what you did", "undo your last move", "reverse course", "back to where you were",
    ),
    "BACKTO": ("[~come|~go|~return|~turn|~move|~get|~swing|~head|~zoom|~pan] back to", "~return to", "back to", "restore", "return the camera to", "~revert to", "~go to", "bring the camera back to", "move the camera back to", "(start|begin|starting|beginning) (at|from)", "~move on to", "~proceed to", "~carry on to"),
    # Scope
    "NOWSCOPE": (
        "right now", "at (the moment|present|this moment)", "currently", "in [the|this|your] (view|current view|present view|frame|current frame|shot|sight)", "in this (image|picture|shot|view|scene)", "in the (image|picture|current image|current picture|current scene|current shot)", "from here", "[visible|seen] on screen", "presently", "in front of you", "in your (view|field of view)", "at this point", "in the field of view", "in your current view", "within view", "within the frame", "in the current field of view", "from this (view|position|angle|viewpoint)", "in what you see", "(visible|that are visible|you can see) [right] now", "in this current view", "on the screen", "in the camera view", "in the camera s view", "on camera", "at the minute", "as of now",
    ),
    "SCENESCOPE": ("in the (scene|area)", "in scene", "on (site|the scene)", "in total", "in all", "altogether", "around here", "on the site", "within the scene", "here", "out there"),
    "FULLSCOPE": (
        f"(in|across|over|on|throughout|of|around|for|through|within|from) {_WHOLE} {_AREA}", "anywhere [around|around you|in the scene|at all|on site|on the site|around here|in the area]", "everywhere [around you|in the scene|you can look]", "all around [you|the camera|us|here|the scene|the site]", "in the (panorama|full view|full scene|wider scene|full sweep|surroundings|whole picture|360 view)", "(across|throughout|around|all over|all across) the (scene|area|site|place|panorama|camera|surroundings|whole place)", "in (all directions|every direction|any direction)", "in total anywhere", "around (you|us|the camera)", "(in|over|across) (a full|the full|all|a) 360 [degrees]", "in a [full] (panorama|sweep|panoramic sweep)", "in (your|the) surroundings", "full scene", "with a full (sweep|panorama)", "overall", "in the whole (view around you|surroundings|panoramic view)", "site wide", "all over the place", "all over [the (site|scene|area)]", "the whole way around", "using [a|the] (full|whole) (sweep|scene|panorama)", "no matter where", "from all angles", "in a full circle", "by sweeping", "nearby",
    ),
    # Quantities
    "ATLEAST": ("at least", "no fewer than", "no less than", "a minimum of", "not less than", "not fewer than", "minimum", "min of"),
    "ATMOST": ("at most", "no more than", "up to", "a maximum of", "not more than", "maximum", "at the most", "max", "at maximum", "with a maximum of", "with at most", "limit of", "for at most", "for a maximum of", "for up to", "with a limit of", "but not more than", "but at most", "but no more than", "but stop after", "stop after", "stopping after", "give up after", "but give up after", "trying at most", "try at most", "to a maximum of", "giving up after", "and give up after", "or at most", "capped at", "in at most", "for no more than", "in no more than", "but do it at most", "do it at most", "and at most"),
    "MORETHAN": ("more than", "over", "greater than", "above", "exceeds", "exceeding", "in excess of"),
    "FEWERTHAN": ("fewer than", "less than", "under", "below"),
    "EXACTLY": ("exactly", "precisely", "only", "just exactly"),
    "ORMORE": ("or more", "or above", "plus", "or greater", "at least", "or over", "at a minimum"),
    "ORFEWER": ("or fewer", "or less", "or under", "at most", "or below"),
    "MOST": ("the most", "the largest number of", "the highest number of", "the greatest number of", "most", "the biggest number of", "the highest count of", "the maximum number of"),
    "FEWEST": ("the fewest", "the least", "the smallest number of", "the lowest number of", "fewest", "the minimum number of", "the least amount of"),
    "MOREOF": ("more", "a (higher|larger|greater|bigger) number of", "a (higher|larger|greater) count of", "more of", "a greater amount of"),
    "FEWEROF": ("fewer", "less", "a (lower|smaller) number of", "fewer of"),
    "ASMANY": ("as many", "the same number of", "equally many", "an equal number of"),
    "INCREASE": ("~increase", "~raise", "~boost", "~add to", "~step up"),
    "DECREASE": ("~decrease", "~reduce", "~lower", "~cut down", "~step down", "~lessen"),
    "HIGHER": ("(greater|higher|larger|bigger|more|up|increased)",),
    "LESSER": ("(smaller|lower|less|fewer|down|decreased)",),
    "NUMEROUS": ("(numerous|common|frequent|plentiful|abundant)",),
    "LISTWORD": ("(available|defined|saved|stored|configured|known|programmed|names|name|list|options|me)", "a list of", "the names of", "the list of", "set up", "i can use", "all the", "all of the"),
    "OUTNUMBER": ("outnumber",),
    "SHOWS": ("shows", "show", "has", "have", "contains", "contain", "sees", "see", "includes", "include", "features", "do you see", "can you see", "are there", "is there", "shows you", "gives you", "hold", "holds", "you see", "you can see", "there are", "captures", "reveal", "reveals", "give", "gives", "expose", "bring up", "bring into view", "display", "displays", "lets you see", "let you see", "will show", "would show"),
    "ANY": ("any", "any of the", "some of the", "one or more", "any sign of", "any kind of", "any other"),
    "NONE": ("no", "zero", "not any", "none of the", "no more", "no other", "not a single", "nobody", "neither"),
    "SEVERAL": ("several", "multiple", "some", "a number of", "various", "a group of", "lots of", "many", "a lot of"),
    "DET": ("the", "a", "an", "these", "those", "all the", "all of the", "all of", "all", "this", "that", "every", "each", "each of the", "every single", "all these", "all those", "your", "our", "my", "its", "their", "one of the", "the other", "another", "both", "every one of the", "the nearest of the"),
    "ONEOF": ("(one|any|it|them|some|none|such) [of (them|those|these)]", "that one", "this one", "either"),
    "PRON": ("it", "them", "him", "her", "that", "this", "they", "he", "she", "that one", "this one", "those", "these", "the same one", "the one", "that thing", "the thing", "the object", "that object"),
    "AGAIN": ("again", "[do|repeat] (that|it|this) (again|once more|one more time)", "once more", "one more time", "~repeat [that|it|this|the last (command|move|action|step)]", "the same again", "do the same [again]", "do that again", "same again", "and again", "repeat"),
    "DOIT": ("do (this|that|it|so|the same|these steps|all that|all this|this sequence)", "~repeat [(this|that|it|these|all of this|all that|these steps|the sequence|the whole thing|both|the process|the above|everything)]", "perform this", "doing (this|that|so)", "do all of that", "run this"),
    "WHATABOUT": ("what about", "how about", "and what about", "and how about", "same (question|count) for"),
    "PREP": (
        "in terms of", "with (respect|regard) to", "regarding", "on the basis of",
        "(on|at|of|with|by|near|behind|beside|under|above|between|from|inside|outside|beyond|against|along|next to|in front of|close to|across|over|below|beneath|off|past|among|alongside|opposite|wearing|holding|carrying|nearest|closest|beneath|per|via|during|out of|on top of|in between|as)",
    ),
    "THATREL": ("that", "who", "that s", "who s", "that is", "that are", "who is", "who are", "which is", "which are"),
    "CANYOU": ("(can|could|would|will) (you|we|u|ya)", "would you mind", "could you perhaps", "are you able to", "is it possible to", "would it be possible to", "could i ask you to", "may i ask you to", "can i get you to", "might you", "do you think you could", "do you mind", "can i", "could i", "may i", "can the camera"),
    "WHEREPOINT": (
        "(where|what direction|which way|in which direction|which direction) are you (pointing|looking|facing|aimed|aiming)", "where is the camera (pointing|looking|facing|aimed)", "what (is|s) (the|your) [current|present] (pan|tilt|zoom|pose|position|zoom level|orientation|heading|pan angle|tilt angle|magnification) [angle|level|position] [right now|now|currently]", "how far (in|zoomed in) are you [zoomed] [in]", "what is the current (pose|zoom)", "report [your|the] (position|pose|current position|current pose)", "which way is the camera (pointing|facing|looking)", "status", "where are you",
    ),
    "HELP": ("help", "what can you do", "what are you able to do", "what commands (do you know|are there|can i use|do you understand)", "help me", "how do i use you", "how does this work", "what can i (ask|say|tell you)"),
    "WHO_ARE": ("who are you", "what are you", "what is your name", "how are you [doing] [today]", "are you (an ai|a robot|human)"),
    "SCRATCH": ("(no wait|wait no|scratch that|i mean|i meant|no sorry|sorry i mean|sorry i meant|correction|make that|no make that|no actually|actually no|oops)",),
}

FILLER: tuple[str, ...] = (
    "please", "pls", "plz", "kindly", "just", "simply", "hey", "hi", "hello", "ok", "okay", "alright", "all right", "right then", "so", "well", "thanks", "thank you", "cheers", "thanks a lot", "many thanks", "thank you very much", "for me", "for us", "to me", "aloud", "out loud", "if you can", "if possible", "if you could", "if you would",
    "if you don t mind", "if you please", "go ahead and", "i [would|d] (like|love) (you|the camera) to", "i (want|need|require) (you|the camera) to", "i d like for you to", "you should", "you need to", "you must", "you can", "we need to", "we should", "let s", "lets", "let us", "now", "quickly", "slowly", "carefully",
    "smoothly", "immediately", "straight away", "at once", "right away", "actually", "maybe", "perhaps", "first", "first of all", "firstly", "secondly", "thirdly", "to begin with", "to start [with]", "also", "as well", "too", "camera", "then stop", "and stop [there]", "and then stop", "hey camera", "hello camera", "the following", "um", "uh", "er", "erm", "hmm", "yo", "dear camera", "mate", "buddy", "sir", "operator", "scope", "hey scope", "attempt to", "try to", "try and", "try", "your task is to",
    "i was wondering if you could", "i wonder if you could", "it would be great if you could", "it would be nice if you could", "be so kind as to", "be a dear and", "make sure to", "make sure you", "remember to", "be sure to", "want you to", "i want to", "i would like to", "i d like to", "i need to", "we want to", "we d like to", "started by", "start by", "begin by", "in order", "real quick", "quick", "good morning", "good afternoon", "good evening", "when you get a chance", "when you can", "when ready", "asap", "gonna", "in that case", "manually", "one after (another|the other)", "one by one", "in turn", "respectively", "in sequence", "after all", "as usual", "steadily", "swiftly", "directly", "exact", "ever so kindly", "do me a favour and", "do me a favor and", "how about you", "why don t you", "you ll need to", "you will need to", "you have to", "would be great", "much appreciated", "next please", "yes", "yeah", "yep", "sure", "and please", "task", "instruction", "command", "hey there", "hi there", "hello there", "gently", "(very|really|nice and) (slowly|slow|carefully|gently|quickly)", "real slow", "slow",
)

NUMBER_WORDS: dict[str, float] = {
    "zero": 0, "one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "seven": 7, "eight": 8, "nine": 9, "ten": 10, "eleven": 11,
    "twelve": 12, "thirteen": 13, "fourteen": 14, "fifteen": 15, "sixteen": 16, "seventeen": 17, "eighteen": 18, "nineteen": 19, "twenty": 20,
    "thirty": 30, "forty": 40, "fourty": 40, "fifty": 50, "sixty": 60, "seventy": 70, "eighty": 80, "ninety": 90, "hundred": 100, "thousand": 1000, "dozen": 12, "couple": 2,
}
FRACTION_WORDS: dict[str, float] = {
    "half": 0.5, "third": 1 / 3, "thirds": 1 / 3, "quarter": 0.25, "quarters": 0.25, "fourth": 0.25, "fourths": 0.25, "fifth": 0.2, "sixth": 1 / 6, "eighth": 0.125, "eighths": 0.125, "tenth": 0.1, "twelfth": 1 / 12,
}
ORDINAL_WORDS: dict[str, int] = {
    "first": 1, "second": 2, "third": 3, "fourth": 4, "fifth": 5, "sixth": 6, "seventh": 7, "eighth": 8, "ninth": 9, "tenth": 10, "last": -1, "final": -1,
}
COLOURS: frozenset[str] = frozenset(
    "red orange yellow green blue purple violet pink brown black white grey gray silver gold beige teal cyan magenta turquoise navy maroon dark light".split()
)
SPELLING: dict[str, str] = {
    "pann": "pan", "paning": "panning", "lef": "left", "letf": "left", "lfet": "left", "rihgt": "right", "rigt": "right", "rigth": "right", "righ": "right", "tlit": "tilt", "tild": "tilt",
    "pictre": "picture", "pitcure": "picture", "piture": "picture", "picutre": "picture", "phto": "photo", "presett": "preset", "prest": "preset", "prset": "preset", "tke": "take", "taek": "take", "gp": "go", "hte": "the", "teh": "the", "adn": "and", "thn": "then", "tehn": "then",
    "dwon": "down", "donw": "down", "hom": "home", "hoem": "home", "folow": "follow", "trakc": "track", "trck": "track", "wich": "which", "manny": "many", "mnay": "many", "visble": "visible", "visable": "visible", "snapsot": "snapshot", "counterclokwise": "counterclockwise", "clokwise": "clockwise", "thee": "the", "centimetre": "centimetres",
}
COMMAND_WORDS: tuple[str, ...] = (
    "pan", "tilt", "zoom", "turn", "rotate", "swivel", "swing", "look", "point", "aim", "move", "shift", "count", "track", "follow", "read", "find", "locate", "show", "focus", "take", "capture", "photograph", "switch", "return", "describe", "compare", "sweep", "panning", "tilting", "zooming", "turning", "rotating", "screenshot", "snapshot",
)
DIRECTION_WORDS: tuple[str, ...] = ("left", "right", "down", "clockwise", "counterclockwise", "anticlockwise", "degrees", "leftwards", "rightwards", "upwards", "downwards")
REAL_WORDS: frozenset[str] = frozenset(
    "truck trucks light lights fight night sight eight might cone cones zone zones room rooms boom van man men can fan ran road head bead lead load tile tiles till tall talk trick trace court mount fountain book books cook hook lock tool turf torn burn sweet tape tale lake cake make bake fake town gown dawn lift loft felt rights rail rain main pain paint joint print mind kind bind wind fine found pane plan plane swim sing wing ring thing coat boat goat house horse mouse hole pole role those whose rent cent tent went test text next best rest west soft sort short shop ship chip clip lamp camp damp".split()
)


def _forms(verb_phrase: str) -> list[str]:
    """The base, third-person and -ing forms of a phrase that starts with a verb."""
    verb, _, rest = verb_phrase.partition(" ")
    stem = verb[:-1] if verb.endswith("e") and not verb.endswith("ee") else verb
    doubled = re.fullmatch(r"[a-z]*[bcdfghjklmnprstvz][aeiou][bdgmnpt]", verb) and verb not in {"open", "visit", "orient", "monitor", "widen", "tighten", "broaden", "enter"}
    gerund = (verb + verb[-1] if doubled else stem) + "ing"
    third = verb + ("es" if verb.endswith(("s", "x", "ch", "sh", "o")) else "s")
    return [f"{form} {rest}".strip() for form in (verb, third, gerund)]


def expand(pattern: str) -> list[tuple[str, ...]]:
    """Every word sequence that a phrase pattern stands for."""
    option = re.search(r"[(\[]([^()\[\]]*)[)\]]", pattern)
    if option:
        choices = option.group(1).split("|") + ([""] if option.group(0)[0] == "[" else [])
        return [words for choice in choices for words in expand(pattern[: option.start()] + choice + pattern[option.end() :])]
    text = " ".join(pattern.split())
    if text.startswith("~"):
        return [tuple(form.split()) for form in _forms(text[1:].strip())]
    return [tuple(text.split())] if text else []


@cache
def phrase_table() -> dict[tuple[str, ...], tuple[str, ...]]:
    """Word sequence to the terminals that it may be, in the order of ``PATTERNS``; ``("FILLER",)`` for words without meaning."""
    table: dict[tuple[str, ...], list[str]] = {}
    for terminal, patterns in (*PATTERNS.items(), ("FILLER", FILLER)):
        for pattern in patterns:
            for words in expand(pattern):
                kinds = table.setdefault(words, [])
                if terminal not in kinds:
                    kinds.append(terminal)
    return {words: tuple(kinds) for words, kinds in table.items()}

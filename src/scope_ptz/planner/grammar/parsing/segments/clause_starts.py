"""Patterns and lists of words that begin a clause."""

from __future__ import annotations

from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS

ENDS = {"STOP": ".", "QUESTION": "?", "COLON": ":"}


SEPARATORS = ("COMMA", "AND", "BUT", "DASH", "OPEN", "CLOSE")


SKIPPED = ("FILLER", "LEADFILLER", "FIRSTLY", "WRAPPER", "COMMA", "INSTEAD", "QUOTE")


GERUNDS = tuple(f"{verb}-ING" for verb in VERBS)


NOUNS_TOO = frozenset({
    "frame", "head", "point", "view", "image", "picture", "shoot", "turn", "track", "step", "record", "log", "note", "report",
    "show", "watch", "display", "tip", "tail", "level", "need", "want", "have", "do", "make", "press", "trim", "shadow", "trail",
    "check", "search", "survey", "face", "angle", "train", "crane", "list", "name", "state", "total", "cover", "drop", "dip",
    "duck", "bow", "start", "end", "stop", "run", "draw", "rock", "pop", "set", "edge", "slide", "drift", "tour", "pick", "cut",
    "change", "tuck", "shift", "patrol", "pull", "capture", "hold", "shot", "store", "monitor", "focus", "swing", "spin",
    "call", "stick", "kick", "chuck", "skip", "export", "access", "twist", "wheel", "rest", "comb", "can", "ask", "nip",
    "tab", "spot", "range",
})  # fmt: skip
"""Words that are verbs or nouns. They begin a clause only if the next word can follow a verb."""


AFTER_VERB = (
    "DET", "PRON", "NUM", "FRACTION", *DIRECTIONS, "IN", "OUT", "LITTLE", "LOT", "LIMIT", "CAMERA", "AROUND", "BACK", "AMOUNTISH",
    "SELF", "HOME", "PRESET", "REVERSE", "PICTURE", "ANOTHER", "HOWMANY", "WHQ", "MORE", "CLOSER", "WIDER", "TELL", "VISIBLE",
)  # fmt: skip


NOUN_LIKE = (
    "FREE",
    "PRESET",
    "NUM",
    "DEG",
    "VISIBLE",
    "CAMERA",
    "PICTURE",
    "HOME",
    "PRON",
    "X",
    "PERCENT",
    "FULL",
    "NOW",
    "LITTLE",
    "LOT",
    "LIMIT",
    "PRESETNOUN",
    "IN",
    "OUT",
    "FILLER",
    "AGAINWORD",
    "STEPNOUN",
    "VIEWNOUN",
    "SECONDS",
    "MINUTES",
    "TURNNOUN",
    "SEE",
    *DIRECTIONS,
)


ADJECTIVES = frozenset({
    "slow", "red", "blue", "green", "white", "black", "yellow", "big", "small", "new", "old", "last", "first", "current",
    "existing",
})  # fmt: skip


BEFORE_NOUN = ("DET", "PREP", "REL", "MODAL", "DOV", "NOT", "SELF", "WRAPPER", "KEEP", "WHQ", "HAVEV", "NEGATED", "ADVERB", "NUM")
"""Classes of words after which a verb without a separator does not begin a clause."""


QUESTION_FORMS = (
    r"(and|so|FILLER)* (HOWMANY|HOWMANYMORE|WHQ|BE (there|DET|PRON|SOMEONE|NOONE|FREE|PRESET|CAMERA)|DOV (?!(DET|FREE)* "
    r"(PRESET|rounds|EVERY|tour|presets)) (DET|"
    r"PRON|SELF|SOMEONE)|HAVEV (DET|SOMEONE|PRON)|MODAL (SELF|DET|PRON) (ADVERB|FILLER)* (SEE|READ)|PREP WHQ|"
    r"(out_of|of) DET|any FREE|DET FREE VISIBLE|(anyone|anybody|anything) )"
)


ASKING = r"_{0,4} (TELL|DESCRIBE|LISTING) "


FRAGMENT = (
    r"(AMOUNTISH|DET|to|PREP)* (LEFT|RIGHT|UP|DOWN) (AMOUNTISH|by)* (NUM|FRACTION|LITTLE|LOT|LIMIT|MORE)|"
    r"(AMOUNTISH|MORE|DET)* (NUM|FRACTION|LITTLE|LOT) (DEG)? (to|over|DET|MORE|AMOUNTISH|PREP)* (LEFT|RIGHT|"
    r"UP|DOWN)|NUM (X|PERCENT) (ZOOM|IN|OUT)|NUM X \Z"
)
"""Beginnings of moves without a verb, as in "left 20" or "10 degrees up"."""


FURTHER = "((another|MORE) (NUM DEG?|LITTLE)|(NUM DEG?|LITTLE) (more|further|MORE))"
"""More of the previous turn, as in "left 5, another 5, another 5"."""


ZOOM_FRAGMENT = r"(NOW)? (IN|OUT) (LITTLE|LOT|LIMIT|MORE)+ (FILLER)* (STOP|COMMA|THEN|AND|\Z)"
"""A zoom without a verb, as in "..., now in a bit"."""


LOOSE_FRAGMENT = (
    r"(AMOUNTISH|BACK|to|PREP|over|the|DET|MORE|IN|OUT)* (LEFT|RIGHT|UP|DOWN|NUM|FRACTION|LITTLE|LOT|LIMIT|"
    r"SAMEAMOUNT|BACK|TWICE|VERTICALUP|VERTICALDOWN)"
)
"""Beginnings of words that continue a move after "and" or a comma, as in "up by 12" or "by another 10"."""


HEADINGS = frozenset(
    {
        "choose",
        "pick",
        "decide",
        "answer",
        "question",
        "guess",
        "steps",
        "tasks",
        "task",
        "instructions",
        "plan",
        "orders",
        "commands",
        "procedure",
        "sequence",
    }
)


TASK_NOUNS = frozenset({
    "test", "check", "set", "tour", "round", "rounds", "run", "job", "task", "request", "order", "sequence", "routine", "drill",
    "procedure", "survey", "inspection", "exercise", "trial", "patrol", "series", "programme", "program", "plan", "steps", "demo",
    "calibration",
})  # fmt: skip
"""The last words of headings that name an activity: "Backlash test:", "Morning round:"."""


STATEMENT = (
    r"((DET)? (FREE|CAMERA|VIEWNOUN|PICTURE)+ 's |(all|only DET? FREE{1,3}) SELF MODAL? "
    r"(HAVEV|SEE|SEE-ED|get)|FREE FREE? 's (PREP|FREE|DET|AMOUNTISH)|"
    r"(FREE)? (wants|needs)|WRAPPER |(SELF|PRON|SOMEONE|there|that|it) (MODAL|DOV|BE|HAVEV|FREE|SHOW|TELL|"
    r"CARRY)|(DET|all|FRACTION|LOT|FREE)+ (FREE|CAMERA|PICTURE|VIEWNOUN)* (BE|HAVEV|MODAL|DOV|WISH) |too "
    r"(much|FREE|LOT|DET)|MODAL not |DOV not SELF|(need|needs|want) (it|PRON|them) |DET FREE{1,2} (FREE|"
    r"CARRY-S|SWITCH-S|TURN-S))"
)
"""Beginnings of statements that say why: "I can't see the doors", "the sun is in the lens", "too much sky"."""


STARTS = (
    r"((wait|hold|remain) (there|here)|park (CAMERA|it|at|DET|SELF|\Z)|up to NUM|"
    r"(another|one|another_one) (of|at|from) DET? PRESET|(do|MODAL) not|HOME|SNAP|PICTURE|ANOTHER (PICTURE|"
    r"DET)?\Z|DET ANOTHER|EACHTIME|ATMOST|REASON|"
    r"NEGATED|RESET|REPEAT|BETWEENEACH|AGAINWORD|UNDO|WIDE|TIGHT|CLOSER|WIDER|FULL|RESETZOOM|BACK|SCAN|"
    r"REVERSE|VERTICALDOWN|VERTICALUP|IFSO|IFNOT|INSTEAD|DET (pan|tilt|zoom|PANNOUN|TILTNOUN|ZOOMNOUN) (to|at|"
    r"NUM)|NUM PICTURE|(with|one) DET? PICTURE|DET (PICTURE)|LEVEL|(at|from|in) DET? PRESET PRESETNOUN? "
    r"COMMA? (COUNT|PAN|TILT|ZOOM|TAKE|TURN|SNAP|HOWMANY|READ|TELL|FIND)|CENTREALL|ZOOMNOUN (to|at|of)? NUM|NUM X (INTURN|"
    r"ATMOST)*(STOP|COMMA|CLOSE|\Z)|pause (STOP|COMMA|THEN|AND|\Z)|TWICE|THRICE|PURPOSE|fill (DET)? (PICTURE|VIEWNOUN|frame))"
)


SET_THERE = "(FILLER|COMMA|LIMIT|LITTLE|LOT)* (ZOOM-ED|PAN-ED|TILT-ED) (LIMIT|LITTLE|LOT|RIGHT|all)* (IN|OUT|LEFT|RIGHT|UP|DOWN|to)"
"""The beginning of words that say how the camera is set at a preset: "the gate, fully zoomed in"."""


PLACE_LEAD = (
    r"(FILLER|FIRSTLY)* (at|from|in|on|for|between|among|out_of|of|using|starting from|starting at|with) (PRESET|HOME|DET|AND|OR|"
    r"PRESETNOUN|COMMA|EVERY|CAMERA|on|at|NUM|ORDINAL)+|(NOW|FULL|FILLER)+|from (LEFT|RIGHT|UP|DOWN|FREE|"
    r"PREP) to? (LEFT|RIGHT|UP|DOWN|FREE)|CAMERA NUM|(in|on|at|behind|between|near|under|beside|among) (DET|"
    r"NUM)* (FREE|PREP|DET|NUM|VISIBLE)+|(FILLER)* for (NUM|DET|FRACTION|AMOUNTISH)* (SECONDS|MINUTES)"
)
"""Places and durations that belong to the clause after the next comma."""


WITHOUT_MOVING = (
    r"without (any|DET|FILLER)* (PAN-ING|TILT-ING|ZOOM-ING|TURN-ING|CARRY-ING|SWITCH-ING|PAN|TILT|ZOOM|movement) (DET|CAMERA|it|"
    r"VIEWNOUN|ZOOMNOUN|PAN|TILT|IN|OUT|at_all|anything|FILLER|OR|ZOOM-ING|PAN-ING|TILT-ING)* (COMMA|STOP|QUESTION|AND|THEN|BUT|\Z)"
)
"""Words that accompany a command and forbid a move: "without zooming", "without moving the camera"."""

"""The parts of an instruction that have one verb (clauses), and the error for a clause that cannot be read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.lexer import Lexeme

DIRECTIONS = ("LEFT", "RIGHT", "UP", "DOWN")
MOTION_VERBS = (
    "PAN", "TILT", "TURN", "CARRY", "DOACT", "AIM", "RAISE", "LOWER", "INCREASE", "DECREASE", "ZOOM", "ENLARGE", "WIDEN", "DOUBLE",
    "TRIPLE", "QUADRUPLE", "HALVE", "LEVEL", "CENTREALL", "REVERSE", "RESETZOOM",
)  # fmt: skip
OTHER_VERBS = (
    "SWITCH", "SHOW", "FIND", "TRACK", "COUNT", "READ", "DESCRIBE", "TELL", "SNAP", "TAKE", "SCAN", "COMPARE", "STAY", "KEEP",
    "REPEAT", "UNDO", "HALT", "LEAVE", "RESET", "LISTING", "HELP",
)  # fmt: skip
VERBS = (*MOTION_VERBS, *OTHER_VERBS)
MARKERS = ("IF", "WHEN", "IFSO", "IFNOT", "UNLESS", "UNTIL", "WHILE", "BEFORE", "AFTER", "REASON")
"""Classes of the words that begin a subordinate clause."""


DANGLING = frozenset({"on", "onto", "to", "at", "of", "with", "by", "for", "towards", "toward", "into", "the", "a"})
"""Words that cannot end a command."""


AS_FAR_AS = (
    r"(as)? (?P<extent>far|much|high|low|wide|close|tight|near|FREE) (DET|FREE|VIEWNOUN|PICTURE)* (as|as_the) (DET|PRON|SELF|"
    r"CAMERA|ZOOMNOUN|possible|she|it)+ (MODAL|DOV|CARRY|CARRY-S|get|will|can|go|goes|manage|allows|FREE)*"
)
"""The pattern for "as far as it goes", which means all the way."""

UNTIL_LIMIT = (
    r"UNTIL (SELF|it|PRON|DET CAMERA) MODAL not (CARRY|get|CARRY-ING)? (no|any)? "
    r"(further|MORE|lower|higher|any_further|no_further)|"
    r"UNTIL (SELF|it|PRON|DET CAMERA) (MODAL)? (hit|hits|reach|reaches|get_to|gets_to|get to|gets to|CARRY to) (DET|its)? "
    r"(LIMIT|end|limit|limits|maximum|max|minimum|stop|stops)"
)
"""The pattern for "until you hit the limit", which means all the way."""


SKIP = "(FILLER|FIRSTLY|LEADFILLER|QUOTE|COMMA)*"
"""The pattern for words at the beginning and end of a clause that add nothing."""

ME = "(me|us|FILLER|(?!(its|their))SELF|back|again|out)*"
"""The pattern for the words after a verb of telling or showing, as in "show me"."""


class NotUnderstoodError(Exception):
    """A clause contains words that could not be interpreted. ``lexemes`` holds these words."""

    def __init__(self, lexemes: Sequence[Lexeme]) -> None:
        super().__init__(" ".join(lexeme.word for lexeme in lexemes))
        self.lexemes = tuple(lexemes)


@dataclass(frozen=True, slots=True)
class Source:
    """The text of an instruction, and the presets of the camera if they are known.

    Attributes:
        has_moved: Whether an earlier clause moves the camera. If so, "the people on the bridge" are expected in the new view.
    """

    text: str
    presets: tuple[str, ...] = ()
    has_moved: bool = False


@dataclass(frozen=True, slots=True)
class Clause:
    """A clause of an instruction.

    Attributes:
        link: What separates it from the previous clause: "and", ",", "then", ".", ":", or "" for nothing.
        marker: The class of the word that makes it subordinate, such as IF; "" for a main clause.
        lexemes: Its lexemes without the separator and the marker.
        is_question: Whether a question mark ends it.
        opener: The lexeme of the marker, or the "so" or "then" before the clause.
    """

    link: str
    marker: str
    lexemes: tuple[Lexeme, ...]
    is_question: bool = False
    opener: Lexeme | None = None


def text_of(source: Source, lexemes: Sequence[Lexeme]) -> str:
    """Return the words of lexemes as the user wrote them, on one line."""
    return " ".join(source.text[lexemes[0].start : lexemes[-1].end].split()) if lexemes else ""


def command_of(lexeme: Lexeme) -> Lexeme | None:
    """Return the command for a past form or participle ("count" for "counted"); None for other words and base forms."""
    verb = next((name for name in VERBS if lexeme.has(f"{name}-ED")), None)
    return None if verb is None or lexeme.has(*VERBS) else lexeme.reworded(verb.lower(), verb)


def trimmed(lexemes: Sequence[Lexeme], *classes: str) -> tuple[Lexeme, ...]:
    """Return lexemes without those of the given classes at either end."""
    first, last = 0, len(lexemes)
    while first < last and lexemes[first].has(*classes):
        first += 1
    while last > first and lexemes[last - 1].has(*classes):
        last -= 1
    return tuple(lexemes[first:last])


def fraction_of(lexeme: Lexeme) -> float:
    """Return the value of a fraction, whose word may also be an ordinal ("third", "eighth")."""
    return 1 / lexeme.value if lexeme.has("ORDINAL") and lexeme.value else lexeme.value

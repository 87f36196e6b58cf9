"""Find the parts of a turn in the words of a clause: directions, amounts, steps and targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from scope_ptz.planner.grammar.instruction_tree import Aim, Amount
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.moves.returns import MULTIPLE, multiple_of
from scope_ptz.planner.grammar.parsing.parts.clause import AS_FAR_AS, DIRECTIONS, UNTIL_LIMIT, fraction_of
from scope_ptz.planner.grammar.parsing.parts.patterns import Match, match_start

TURN_VERBS = ("PAN", "TILT", "TURN", "CARRY", "DOACT", "AIM", "RAISE", "LOWER", "INCREASE", "DECREASE", "KEEP", "SCAN", "SHOW")


TURN_GERUNDS = tuple(f"{verb}-ING" for verb in TURN_VERBS)


ALLOWED_IN_TURNS = (
    *TURN_VERBS, *TURN_GERUNDS, *(f"{verb}-ED" for verb in TURN_VERBS), "CAMERA", "VIEWNOUN", "PICTURE", "PRON", "DET", "AMOUNTISH",
    "MORE", "SIDE", "TURNNOUN", "FILLER", "SELF", "GLUE", "DIAGONALLY", "ATSAMETIME", "ABSOLUTE", "WHOLETHING", "COMMA",
    "PANNOUN", "TILTNOUN", "DEG", "LEADFILLER", "QUOTE", "INTURN", "AROUND", "FIRSTLY", "REVERSE", "BACK", "BUT",
)  # fmt: skip
"""Classes of words that a turn may contain besides amounts and directions."""


SURFACE_BELOW_OR_ABOVE = (
    "(at|to|towards|toward|onto) (DET)? (ground|floor|pavement|road|street|tarmac|grass|path|sky|ceiling|clouds) (?!FREE)"
)
"""What a camera sees at the limit of its tilt: "all the way down at the ground" asks for the limit, not for a close-up."""

_NUMBER = "(AMOUNTISH|and)* (?P<number>NUM) (?!VIEWNOUN|PICTURE) (AMOUNTISH)*"


_CHUNKS = (
    ("shared", r"each (way|direction|SIDE)"),
    ("reverse", r"REVERSE"),
    ("turn", r"LIMIT AROUND"),
    ("right angle", r"(by|through|DET)* ((?P<fraction>FRACTION) (of)? (DET)? )?RIGHTANGLE"),
    ("steps", r"(in|by|with|using|at)? (DET)? (?P<count>NUM) STEPNOUN of (?P<size>NUM) DEG? (each)?"),
    ("parts", r"(in|over) (?P<count>NUM) STEPNOUN"),
    ("times", r"(in|over)? (?P<number>NUM) STEPNOUN (?=(to|DET)* (LEFT|RIGHT|UP|DOWN) (of|by|at|COMMA)* NUM DEG)"),
    ("steps", r"(in|by|with|using|at)? (DET)? (?P<count>NUM) (jumps of|STEPNOUN of)? (?P<size>NUM) DEG? STEPNOUN"),
    ("steps", r"(in|with|by|using|at)? (DET)? STEPNOUN of (about|AMOUNTISH)? (?P<size>NUM) DEG?"),
    ("steps", r"(in|with|by|using|at)? (?P<size>NUM) DEG? (STEPNOUN|ATATIME)"),
    ("steps", r"(in|with|using|by) (?P<small>small|little|short|LITTLE) STEPNOUN"),
    ("steps", r"(?P<small>LITTLE) ATATIME"),
    ("same", rf"(by)? {MULTIPLE}"),
    ("times", (
r"(?P<number>NUM) X (INTURN|AMOUNTISH)*(?! SAMEAMOUNT)|X (?P<number2>NUM)|(?P<twice>TWICE)(?! (SAMEAMOUNT|"
r"ASCLOSE))|(?P<thrice>THRICE)(?! SAMEAMOUNT)"
)),
    ("turn", (
r"(AMOUNTISH|DET|by)* ((?P<number>NUM) )?(?P<fraction>FRACTION) (of)? (DET)? (full|complete|whole|LIMIT|"
r"MAX)? (TURNNOUN|(of the|the)? (way|LIMIT) AROUND|way AROUND|of the way AROUND)"
)),
    ("turn", r"(AMOUNTISH|DET|by)* ((?P<number>NUM) )?(?P<fraction>FRACTION) (of) (DET)* way AROUND"),
    ("turn", r"(AMOUNTISH|DET)* ((?P<number>NUM) )?(full|complete|whole|entire|LIMIT) (TURNNOUN)"),
    ("turn", r"(?P<number>NUM) (turns|rotations|revolutions|circles)"),
    ("part", r"(AMOUNTISH|DET)* ((?P<times>NUM) )?(?P<fraction>FRACTION) (of)? ((?P<number>NUM)|DET)? DEG"),
    ("turn", r"by DET? (?P<fraction>FRACTION)"),
    ("turn", r"DET (?P<fraction>quarter) (?=(to)? (DET|SELF)? (LEFT|RIGHT))"),
    ("couple", r"(by|just)? (a_couple_of|couple_of) (more)? DEG"),
    ("axis", r"(?P<axis>PANNOUN|TILTNOUN) (to|of|at|is)? (?P<number>NUM) DEG?"),
    ("target", (
r"(to|at|until it is at) (DET|ABSOLUTE|PANNOUN|TILTNOUN|TURNNOUN|of|exactly)* (?P<number>NUM) DEG? "
r"(ABSOLUTE)?(?! (to|LEFT|RIGHT|UP|DOWN|on))"
)),
    ("limit", AS_FAR_AS),
    ("limit", UNTIL_LIMIT),
    ("limit", r"(LIMIT) (of)? (DET)* "),
    ("amount", rf"{_NUMBER} (DEG)? "),
    ("lot", r"(AMOUNTISH|DET)* LOT (MORE)? "),
    ("little", r"(AMOUNTISH|DET)* LITTLE (MORE|of)* "),
    ("same", r"(by)? (SAMEAMOUNT|(same|same_again) (?=(to)? (DET|SELF)? (LEFT|RIGHT|UP|DOWN)))"),
    ("direction", r"(?P<LEFT>LEFT)|(?P<RIGHT>RIGHT)|(?P<UP>UP)|(?P<DOWN>DOWN)"),
)  # fmt: skip


AXES: dict[str, tuple[Literal["pan", "tilt"], int]] = {
    "LEFT": ("pan", -1),
    "RIGHT": ("pan", 1),
    "UP": ("tilt", 1),
    "DOWN": ("tilt", -1),
}


_SMALL_STEP_DEG = 5.0


@dataclass
class TurnParts:
    """The parts of a turn. ``parts`` lists the directions and amounts in the order in which they occur."""

    parts: list[str | Amount] = field(default_factory=list)
    target: float | None = None
    aims: list[Aim] = field(default_factory=list)
    step: Amount | None = None
    count: int | None = None
    divides: bool = False
    times: int = 1

    @property
    def directions(self) -> list[str]:
        return [part for part in self.parts if isinstance(part, str)]

    @property
    def amounts(self) -> list[Amount]:
        return [part for part in self.parts if isinstance(part, Amount)]


def find_parts(lexemes: Sequence[Lexeme]) -> tuple[TurnParts, list[Lexeme], list[Lexeme]]:
    """Return the parts of a turn, the other words that a turn may contain, and the words that no turn contains."""
    found, allowed, unread = TurnParts(), list[Lexeme](), list[Lexeme]()
    i = 0
    while i < len(lexemes):
        rest = lexemes[i:]
        first = rest[0]
        verb_direction = (
            "UP" if first.has("RAISE", "RAISE-ING", "RAISE-ED") else "DOWN" if first.has("LOWER", "LOWER-ING", "LOWER-ED") else ""
        )
        is_verb = not allowed and not found.parts
        if verb_direction and (is_verb or not first.has(*DIRECTIONS)):
            found.parts.append(verb_direction)
            allowed.append(first)
            i += 1
            continue
        if (ground := match_start(SURFACE_BELOW_OR_ABOVE, rest)) is not None and _ends_at_vertical_limit(found):
            allowed += rest[: ground.size]
            i += ground.size
            continue
        match, name = next(((m, name) for name, pattern in _CHUNKS if (m := match_start(pattern, rest)) and m.size), (None, ""))
        if match and not (first.has("TURNNOUN", "CARRY", "AIM", "TILT", "PAN", "TURN") and name in {"lot", "little"}):
            _add(found, name, match)
            i += match.size
        elif first.has(*ALLOWED_IN_TURNS) and not first.has("NEGATED", "NOT", "NONE"):
            allowed.append(first)
            i += 1
        else:
            unread.append(first)
            i += 1
    return found, allowed, unread


def _ends_at_vertical_limit(found: TurnParts) -> bool:
    """Return whether the parts found so far tilt all the way up or down."""
    return Amount("limit") in found.amounts and bool(found.directions) and set(found.directions) <= {"UP", "DOWN"}


def _add(found: TurnParts, name: str, match: Match) -> None:
    """Add the part of a turn that a pattern matched."""
    value = match["number"][0].value if "number" in match.names and match["number"] else None
    if name == "shared":
        return  # a single amount always applies to all directions
    if name == "steps":
        size = _SMALL_STEP_DEG if "small" in match.names else abs(match["size"][0].value)
        found.step = Amount("degrees", size)
        found.count = max(1, round(match["count"][0].value)) if "count" in match.names and match["count"] else None
    elif name == "parts":
        number = abs(match["count"][0].value)
        found.step, found.count, found.divides = Amount("degrees", number), max(1, round(number)), True
    elif name == "times":
        number = value if value is not None else match["number2"][0].value if match["number2"] else 2 if match["twice"] else 3
        found.times = max(1, min(round(number), 50))
    elif name == "turn":
        part = fraction_of(match["fraction"][0]) if match.has("fraction") else 1.0
        found.parts.append(Amount("degrees", round(360 * (value or 1.0) * part, 6)))
    elif name == "right angle":
        part = fraction_of(match["fraction"][0]) if match.has("fraction") else 1.0
        found.parts.append(Amount("degrees", 90.0 * part))
    elif name == "part":
        times = match["times"][0].value if match["times"] else 1.0
        found.parts.append(Amount("degrees", times * fraction_of(match["fraction"][0]) * (value if value is not None else 1.0)))
    elif name == "couple":
        found.parts.append(Amount("degrees", 2.0))
    elif name == "axis":
        found.aims.append(Aim("pan" if match["axis"][0].has("PANNOUN") else "tilt", value or 0.0))
    elif name == "target":
        found.target = value
    elif name == "amount":
        found.parts.append(Amount("degrees", value or 0.0))
    elif name == "reverse":
        found.parts.append(Amount("degrees", 180.0))  # "do a one-eighty to the right"
    elif name == "same":
        found.parts.append(Amount("same", factor=multiple_of(match)))
    elif name == "direction":
        found.parts.append(next(way for way in DIRECTIONS if match[way]))
    else:
        found.parts.append(Amount(name))  # type: ignore[arg-type]

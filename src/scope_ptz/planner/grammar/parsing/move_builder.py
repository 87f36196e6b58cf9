"""Build camera moves from the parse tree."""

# ruff: noqa: ARG002 - all rule methods share one signature

from __future__ import annotations

from typing import Any

from scope_ptz.planner.grammar.instruction_tree import Aim, Amount, Back, Move, Part, Turn, Unclear, Zoom
from scope_ptz.planner.grammar.parsing.tree_nodes import Node, TreeVisitor

_DIRECTIONS: dict[str, tuple[tuple[str, int], ...]] = {
    "left": (("pan", -1),),
    "right": (("pan", 1),),
    "up": (("tilt", 1),),
    "down": (("tilt", -1),),
    "up_left": (("tilt", 1), ("pan", -1)),
    "up_right": (("tilt", 1), ("pan", 1)),
    "down_left": (("tilt", -1), ("pan", -1)),
    "down_right": (("tilt", -1), ("pan", 1)),
}
_LITTLE_ZOOM, _LOT_ZOOM, _PLAIN_ZOOM = 1.25, 4.0, 2.0  # factors for "a little", "a lot" and no amount
_AIMING = (
    "point",
    "aim",
    "look",
    "turn",
    "direct",
    "train",
    "swing",
    "orient",
    "rotat",
)
"""Beginnings of the verbs of LOOKAT that aim the camera; the other verbs zoom in."""

_SMALL_STEP_DEG = 5.0
# Terminals of words that name a move.
_VERBS = (
    "PAN",
    "MOVE",
    "LOOK",
    "TILT",
    "SWEEP",
    "SWITCH",
    "PANNOUN",
    "TILTNOUN",
    "INCREASE",
    "DECREASE",
    "TURNAROUND",
    "UP",
    "DOWN",
)


class StepSize:
    """The size of the steps of a move: "in 15 degree steps".

    Attributes:
        size: The size of one step.
        count: The number of steps, if the instruction gives it.
        divides_move: Whether the count divides the whole move, as in "20 degrees in 2 steps".
    """

    def __init__(self, size: Amount, count: int | None = None, divides_move: bool = False) -> None:
        self.size, self.count, self.divides_move = size, count, divides_move


class MoveBuilder(TreeVisitor):
    """Visitor that builds moves and their amounts."""

    # Amounts -----------------------------------------------------------------------------------------------------------
    def degrees(self, node: Node) -> Amount:
        return Amount("degrees", self.visit(node.branches()[0]))

    def little(self, node: Node) -> Amount:
        return Amount("little")

    def lot(self, node: Node) -> Amount:
        return Amount("lot")

    def limit(self, node: Node) -> Amount:
        return Amount("limit")

    def unsaid(self, node: Node) -> Amount:
        return Amount("unspecified")

    def same(self, node: Node) -> Amount:
        return Amount("same")

    def angle_number(self, node: Node) -> float:
        return self.number(node)

    def angle_part(self, node: Node) -> float:
        count = self.number(node) if node.has("NUM") else 1.0
        return round(360 * count * self.fraction(node), 6)

    def angle_fraction(self, node: Node) -> float:
        return self.fraction(node)

    def angle_full(self, node: Node) -> float:
        return 360.0

    def angle_turns(self, node: Node) -> float:
        return 360.0 * self.number(node)

    def angle_right(self, node: Node) -> float:
        return 90.0

    def step_of(self, node: Node) -> StepSize:
        return StepSize(Amount("degrees", abs(self.visit(node.branches()[0]))))

    def in_steps(self, node: Node) -> StepSize:
        number = abs(self.number(node))
        return StepSize(Amount("degrees", number), max(1, round(number)), divides_move=True)

    def step_small(self, node: Node) -> StepSize:
        return StepSize(Amount("degrees", _SMALL_STEP_DEG))

    def steps_of(self, node: Node) -> StepSize:
        return StepSize(Amount("degrees", abs(self.visit(node.branches()[0]))), max(1, round(self.number(node))))

    def how(self, node: Node) -> Any:
        return self.visit(node.branches()[0])

    # Turns -------------------------------------------------------------------------------------------------------------
    def move(self, node: Node) -> Move | Unclear:
        parts: list[Part] = []
        for branch in node.branches():
            result = self.visit(branch)
            if isinstance(result, Unclear):
                return result
            parts.extend(result)
        axes = [p.axis if not isinstance(p, Zoom) else "zoom" for p in parts]
        if len(set(axes)) < len(axes):
            return Unclear("That asks for two moves about the same axis at once. Which one shall I make?")
        for leaf in node.all_leaves():
            if (
                leaf.kind == "TILT"
                and any(isinstance(p, Turn) and p.axis == "pan" for p in parts)
                and not any(p.axis == "tilt" for p in parts if not isinstance(p, Zoom))
            ):
                return Unclear("The camera tilts up and down and pans left and right. Which of the two shall I do?")
        kinds = {leaf.kind for leaf in node.branches()[0].all_leaves()}
        return Move(tuple(parts), has_verb=bool(kinds & {*_VERBS, "ZOOM", "LOOKAT", "SET", "CLOSER", "WIDER", "LEVEL"}))

    def _turns(self, node: Node, directions: list[tuple[str, int]]) -> tuple[Part, ...]:
        """Return turns in the given directions, with the amount and step size of the node."""
        amount: Amount | None = None
        step: StepSize | None = None
        for how in node.branches("how"):
            result = self.visit(how)
            if isinstance(result, StepSize):
                step = result
            else:
                amount = result
        if step and step.divides_move and step.count and amount and amount.kind == "degrees":
            step = StepSize(Amount("degrees", abs(amount.degrees) / step.count), step.count)
        elif step and step.divides_move:
            step = StepSize(step.size)
        return tuple(
            Turn(axis, sign, amount, step.size if step else None, step.count if step else None)  # type: ignore[arg-type]
            for axis, sign in directions
        )

    def turn(self, node: Node) -> tuple[Part, ...]:
        direction = next(b.name for b in node.branches() if b.name in _DIRECTIONS)
        return self._turns(node, list(_DIRECTIONS[direction]))

    turn_late = turn

    def turn_at(self, node: Node) -> tuple[Part, ...] | Unclear:
        """Build "point the camera to the left". "Zoom in on the left" names no object, so it becomes a question to the user."""
        if not self.words_of(node.leaves("LOOKAT")[0]).startswith(_AIMING):
            return Unclear("On what shall I zoom in?")
        return self.turn(node)

    def turn_two(self, node: Node) -> tuple[Part, ...] | Unclear:
        directions = [d for b in node.branches() if b.name in _DIRECTIONS for d in _DIRECTIONS[b.name]]
        if len({axis for axis, _ in directions}) < 2:
            return Unclear("Those two directions cancel out. Which way shall I turn?")
        return self._turns(node, directions)

    def raise_it(self, node: Node) -> tuple[Part, ...]:
        return self._turns(node, [("tilt", 1 if node.has("UP") else -1)])

    def pan_only(self, node: Node) -> tuple[Part, ...] | Unclear:
        """Build "pan 25" and "pan -30": as in the tools, positive angles are to the right."""
        return self._signed(node, "pan") or Unclear("Shall I turn left or right?")

    def tilt_only(self, node: Node) -> tuple[Part, ...] | Unclear:
        return self._signed(node, "tilt") or Unclear("Shall I tilt up or down?")

    def _signed(self, node: Node, axis: str) -> tuple[Part, ...]:
        """Return a turn whose sign states the direction; nothing without an angle ("turn a bit")."""
        turns = self._turns(node, [(axis, 1)])
        return turns if any(leaf.kind in {"NUM", "FRACTION", "CIRCLE", "FULLTURN", "STEPS"} for leaf in node.all_leaves()) else ()

    def pan_less(self, node: Node) -> tuple[Part, ...]:
        return self._turns(node, [("pan", -1)])

    def tilt_less(self, node: Node) -> tuple[Part, ...]:
        return self._turns(node, [("tilt", -1)])

    def pan_more(self, node: Node) -> tuple[Part, ...]:
        return self._turns(node, [("pan", 1)])

    def tilt_more(self, node: Node) -> tuple[Part, ...]:
        return self._turns(node, [("tilt", 1)])

    def turn_round(self, node: Node) -> tuple[Part, ...] | Unclear:
        if node.has("AROUND") and self.words_of(node.leaves()[0]).startswith("pan"):
            return Unclear("How far shall I pan, and which way?")
        return (Turn("pan", 1, Amount("degrees", 180.0)),)

    def straight_down(self, node: Node) -> tuple[Part, ...]:
        return (Turn("tilt", -1, Amount("limit")),)

    def straight_up(self, node: Node) -> tuple[Part, ...]:
        return (Turn("tilt", 1, Amount("limit")),)

    def other_part(self, node: Node) -> tuple[Part, ...] | Unclear:
        result: tuple[Part, ...] | Unclear = self.visit(node.branches()[0])
        return result

    # Absolute targets --------------------------------------------------------------------------------------------------
    def _aimed(self, node: Node, axis: Any) -> tuple[Part, ...]:
        value = next(self.visit(b) for b in node.branches() if b.name.startswith("angle"))
        signs = [sign for b in node.branches() if b.name in _DIRECTIONS for a, sign in _DIRECTIONS[b.name] if a == axis]
        return (Aim(axis, -abs(value) if signs[-1:] == [-1] else value),)

    def pan_to(self, node: Node) -> tuple[Part, ...] | Unclear:
        if any(not self.words_of(leaf).startswith(_AIMING) for leaf in node.leaves("LOOKAT")):
            return Unclear("On what shall I zoom in?")
        is_place = node.has("BACKTO", "MOVE", "SWITCH") and not any(leaf.kind == "DEG" for leaf in node.all_leaves())
        if is_place and not node.has("PANNOUN"):
            return Unclear("Is that number the pan angle in degrees, or the number of a preset?")
        vertical = any(b.name in {"up", "down"} for b in node.branches())
        return self._aimed(node, "tilt" if vertical else "pan")

    turn_to = pan_to

    def tilt_to(self, node: Node) -> tuple[Part, ...]:
        return self._aimed(node, "tilt")

    pan_value = pan_to
    tilt_value = tilt_to

    def zoom_value(self, node: Node) -> tuple[Part, ...]:
        return (Aim("zoom", self.number(node)),)

    def axes(self, node: Node) -> tuple[Part, ...]:
        return tuple(part for branch in node.branches() for part in self.visit(branch))

    def face_ahead(self, node: Node) -> tuple[Part, ...] | Unclear:
        if node.has("MOVE", "SWITCH") and self.text(node.leaves("AHEAD")).lower().startswith("forward"):
            return Unclear("The camera cannot travel; it turns and zooms. Shall I zoom in?")
        return (Aim("pan", 0.0),)

    def above_level(self, node: Node) -> tuple[Part, ...]:
        return (Aim("tilt", abs(next(self.visit(b) for b in node.branches() if b.name.startswith("angle")))),)

    def below_level(self, node: Node) -> tuple[Part, ...]:
        return (Aim("tilt", -abs(next(self.visit(b) for b in node.branches() if b.name.startswith("angle")))),)

    def heading(self, node: Node) -> Unclear:
        return Unclear(
            "I have no compass: I know directions only as left and right of where the camera points. Which way shall I turn?"
        )

    def level(self, node: Node) -> tuple[Part, ...]:
        return (Aim("tilt", 0.0),)

    def centre_all(self, node: Node) -> tuple[Part, ...]:
        return (Aim("pan", 0.0), Aim("tilt", 0.0))

    # Zoom --------------------------------------------------------------------------------------------------------------
    def zin(self, node: Node) -> int:
        return 1

    def zout(self, node: Node) -> int:
        return -1

    def _zoomed(self, node: Node, sign: int, bare: bool = False) -> tuple[Part, ...] | Unclear:
        amounts = [b for b in node.branches() if b.name.startswith("z_")]
        if not amounts:
            return (Zoom("factor", _PLAIN_ZOOM if sign > 0 else 1 / _PLAIN_ZOOM),)
        kind, value = self.visit(amounts[0])
        if kind == "percent" and value < 0:
            return (Zoom("percent", value),) if sign < 0 or bare else Unclear("Shall I zoom in or out?")
        if kind in {"factor", "fraction"} and not 0 < value < float("inf"):
            return Unclear("How many times shall I zoom?")
        if kind == "limit":
            return (Zoom("in" if sign > 0 else "out"),)
        if kind == "percent":
            if sign < 0 and value >= 100:
                return Unclear("I can zoom out by less than 100 per cent. By how many times shall I zoom out?")
            return (Zoom("percent", sign * value),)
        if kind == "factor" and sign > 0 and value < 1 and not bare:
            return Unclear("A factor below 1 zooms out. Shall I zoom in or out, and how many times?")
        if kind == "fraction":
            return (Zoom("factor", 1 + value if sign > 0 else 1 - value),)
        return (Zoom("factor", value if sign > 0 or value < 1 else 1 / value),)

    def zoom_rel(self, node: Node) -> tuple[Part, ...] | Unclear:
        sign = next(self.visit(b) for b in node.branches() if b.name in {"zin", "zout"})
        return self._zoomed(node, sign)

    def zoom_rel_late(self, node: Node) -> tuple[Part, ...] | Unclear:
        """Build "zoom in, but only a little"."""
        return self.zoom_rel(node.branches()[0])

    def zoom_limit(self, node: Node) -> tuple[Part, ...]:
        return (Zoom("in" if self.visit(node.branches()[0]) > 0 else "out"),)

    def zoom_right(self, node: Node) -> tuple[Part, ...] | Unclear:
        """Build "zoom right out", where "right" means all the way."""
        return (
            self.zoom_limit(node) if self.text(node.leaves("RIGHT")).lower() == "right" else Unclear("Shall I zoom, or turn right?")
        )

    def zoom_more(self, node: Node) -> tuple[Part, ...] | Unclear:
        return self._zoomed(node, 1)

    def zoom_less(self, node: Node) -> tuple[Part, ...] | Unclear:
        return self._zoomed(node, -1)

    def zoom_bare(self, node: Node) -> tuple[Part, ...] | Unclear:
        amounts = [b.name for b in node.branches()]
        if not amounts or amounts[0] in {"z_little", "z_lot", "z_plain"}:
            return Unclear("Shall I zoom in or out?")
        return self._zoomed(node, 1, bare=True)

    def zoom_double(self, node: Node) -> tuple[Part, ...]:
        words = " ".join(self.words_of(leaf) for leaf in node.leaves())
        return (Zoom("factor", 3.0 if "tripl" in words or "thr" in words else 4.0 if "quadr" in words or "four" in words else 2.0),)

    def zoom_halve(self, node: Node) -> tuple[Part, ...]:
        return (Zoom("factor", 1 / (3.0 if any("thr" in self.words_of(leaf) for leaf in node.leaves()) else 2.0)),)

    def zoom_to_value(self, node: Node) -> tuple[Part, ...] | Unclear:
        if self.number(node) <= 0:
            return Unclear("To how many times shall I zoom?")
        return (Aim("zoom", self.number(node), self._sense(node)),)

    def zoom_to_percent(self, node: Node) -> tuple[Part, ...]:
        return (Aim("zoom", self.number(node) / 100, self._sense(node)),)

    def _sense(self, node: Node) -> int:
        """Return the direction of "zoom in to 2x": +1 for in, -1 for out, 0 if there is none."""
        inwards = node.has("INCREASE") or any(b.name == "zin" for b in node.branches())
        outwards = node.has("DECREASE") or any(b.name == "zout" for b in node.branches())
        return inwards - outwards

    def zoom_max(self, node: Node) -> tuple[Part, ...]:
        return (Zoom("in"),)

    def zoom_min(self, node: Node) -> tuple[Part, ...]:
        return (Zoom("out"),)

    def z_factor(self, node: Node) -> tuple[str, float]:
        return ("percent" if node.has("PERCENT") else "factor"), self.number(node)

    def z_twice(self, node: Node) -> tuple[str, float]:
        words = " ".join(self.words_of(leaf) for leaf in node.leaves())
        return "factor", 3.0 if "thr" in words else 4.0 if "four" in words else 2.0

    def z_fraction(self, node: Node) -> tuple[str, float]:
        return "fraction", self.fraction(node)

    def z_percent(self, node: Node) -> tuple[str, float]:
        return "percent", self.number(node)

    def z_little(self, node: Node) -> tuple[str, float]:
        return "factor", _LITTLE_ZOOM

    def z_lot(self, node: Node) -> tuple[str, float]:
        return "factor", _LOT_ZOOM

    def z_limit(self, node: Node) -> tuple[str, float]:
        return "limit", 0.0

    def z_plain(self, node: Node) -> tuple[str, float]:
        return "factor", _PLAIN_ZOOM

    # Back --------------------------------------------------------------------------------------------------------------
    def go_back(self, node: Node) -> Any:
        amounts = [self.visit(b) for b in node.branches()]
        return Back(amount=amounts[0]) if amounts else Back()

    def zoom_back(self, node: Node) -> Back:
        return Back(zoom_only=True)

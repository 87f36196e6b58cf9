"""The state of one run, and the calls that it makes."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.grammar.execution import answer_sentences as phrases
from scope_ptz.planner.grammar.execution import move_sentences as motion
from scope_ptz.planner.grammar.execution.camera_history import PositionHistory, VisitedPosition, is_same_pose

if TYPE_CHECKING:
    from scope_ptz.planner.base import Viewpoints

_MIN_LISTED_STOPS = 3
"""Minimum number of presets in an answer with a line for each of them."""

_MOVING_TOOLS = frozenset({"adjust_ptz", "go_home", "go_to_preset", "zoom_to_object", "track_object"})
_MOVES = frozenset({"adjust_ptz", "go_to_preset", "go_home"})
"""The tools after which the camera is no longer at a close-up."""

CallRequest = tuple[str, dict[str, Any]]
"""The name and arguments of a requested tool call."""


class Outcome(Protocol):
    """The outcome of a tool call: its result as JSON data, or ``error`` if it failed."""

    @property
    def result(self) -> dict[str, Any] | None: ...

    @property
    def error(self) -> str | None: ...


CallGenerator = Generator[CallRequest, Outcome, Any]


@dataclass(frozen=True, slots=True)
class AssumedOutcome:
    """The assumed outcome of a call that was not made."""

    result: dict[str, Any]
    error: None = None


@dataclass(frozen=True, slots=True)
class Offer:
    """An offer to go closer, which the user has not accepted yet.

    Attributes:
        thing: What to zoom in on.
        question: The question to ask again.
        pose: The camera's pose when the question was asked.
    """

    thing: str
    question: str
    pose: Pose


class HaltedError(Exception):
    """An error that ends the run. The message gives the reason and becomes part of the answer."""


@dataclass
class RunState:
    """The state of one run.

    Attributes:
        pose: The camera's pose, updated after every call.
        positions: The camera's positions in earlier turns of the conversation.
        viewpoint: The camera's viewpoint; empty if it is unknown, None for a camera that has a single one.
        viewpoints: The viewpoints of the presets; None for a camera that has a single one.
        assume_met: Whether to treat every condition as met, for plans without a camera.
        may_go_closer: Whether the camera may zoom in by itself when something is too small. Otherwise, the answer offers to.
        wider_view: The pose from which the camera zoomed in on a thing; None if it is not at a close-up.
        moves_are_forbidden: Whether the user forbids camera moves.
        notes: The sentences of the answer.
        stops: The indices of the notes with which the report about a preset begins.
        sources: The sources of the perception results.
        surveyed: The presets that a survey has visited since the last move that a note reports.
    """

    limits: Limits
    pose: Pose
    positions: PositionHistory = field(default_factory=PositionHistory)
    assume_met: bool = False
    may_go_closer: bool = False
    viewpoint: str | None = None
    viewpoints: Viewpoints | None = None
    wider_view: Pose | None = None
    moves_are_forbidden: bool = False
    offers: list[Offer] = field(default_factory=list)  # closer looks that the user must allow first
    notes: list[str] = field(default_factory=list)
    stops: list[int] = field(default_factory=list)
    sources: list[str] = field(default_factory=list)
    surveyed: tuple[str, ...] = ()
    _not_found: set[str] = field(default_factory=set)  # descriptions of objects that were not found
    _visited: list[VisitedPosition] = field(default_factory=list)  # positions to which "go back" can return
    _best_preset: str | None = None  # the preset for "go there" after a comparison; None if there is no winner
    _moved_to_object: bool = False  # whether a perception tool moved the camera after the last move to a preset or home
    _went_home: bool = False  # whether the run has moved the camera to home
    _last_count: int = -1  # the last count in a condition; -1 if there was none
    _last_was_yes: bool | None = None  # whether the last answer was yes or the last look found something; None if unknown

    def answer(self) -> str:
        """Return the answer: all notes, and the note about the sources. The report of a long tour has a line for each preset."""
        starts = self.stops if len(self.stops) >= _MIN_LISTED_STOPS else ()
        notes = (("\n" if i in starts else " ") + phrases.sentence(note) for i, note in enumerate(self.notes) if note)
        return ("".join(notes).strip() or "There was nothing to do.") + phrases.source_text(self.sources)

    def _note(self, text: str) -> None:
        self.notes.append(text)

    def _call(self, tool: str, **arguments: Any) -> CallGenerator:
        """Make a tool call, update the pose and the sources from its result, and return its outcome."""
        outcome = yield tool, arguments
        result = outcome.result
        if outcome.error is None and result and isinstance(pose := result.get("pose"), dict):
            self.pose = Pose(pose["pan_deg"], pose["tilt_deg"], pose["zoom"])
            self._note_viewpoint(tool, arguments)
            self.surveyed = () if tool in _MOVING_TOOLS else self.surveyed
            self.wider_view = None if tool in _MOVES else self.wider_view
        if result and (source := result.get("source")) and source not in self.sources:
            self.sources.append(source)
        return outcome

    def _note_viewpoint(self, tool: str, arguments: Mapping[str, Any]) -> None:
        """Note the viewpoint after a successful call. Only presets and home can change it."""
        if self.viewpoints is not None and tool == "go_to_preset":
            self.viewpoint = self.viewpoints.of_presets.get(str(arguments.get("name")), "")
        elif self.viewpoints is not None and tool == "go_home":
            self.viewpoint = self.viewpoints.home or ""

    def _shortfall_text(self, result: Mapping[str, Any], wanted: Pose) -> str:
        """Return the words that state why a move ended before the wanted pose; empty if it did not."""
        return "" if is_same_pose(self.pose, wanted) else motion.shortfall_text(result)

    def _here(self) -> VisitedPosition:
        """Return the camera's current position."""
        return VisitedPosition(self.pose, viewpoint=self.viewpoint)

    def _camera_call(self, tool: str, **arguments: Any) -> CallGenerator:
        """Make a camera call and return its result. A failure ends the run, because later steps depend on the pose."""
        outcome: Outcome = yield from self._call(tool, **arguments)
        if outcome.error is not None or outcome.result is None:
            raise HaltedError(f"I stopped because the camera did not do {tool}: {outcome.error or 'no result'}")
        return outcome.result

    def _perception_call(self, tool: str, **arguments: Any) -> CallGenerator:
        """Make a perception call and return its result. If it fails twice, add a note to the answer and return None.

        A question that perception does not understand is not asked again.
        """
        outcome: Outcome = yield from self._call(tool, **arguments)
        if outcome.error is not None and not phrases.not_understood_text(outcome.error):
            outcome = yield from self._call(tool, **arguments)
        if outcome.error is not None or outcome.result is None:
            error = outcome.error or "no result"
            note = phrases.not_understood_text(error) or f"I could not look ({tool} failed): {error}"
            if self.notes[-1:] != [note]:
                self._note(note)
            return None
        return outcome.result

    def _required_perception_call(self, tool: str, **arguments: Any) -> CallGenerator:
        """Make a perception call that later steps depend on, and return its result. A failure ends the run."""
        result = yield from self._perception_call(tool, **arguments)
        if result is None:
            raise HaltedError("I stopped there, because the next step depends on the answer")
        return result

"""The state of one run, and the calls that it makes."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any, Protocol

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.grammar.execution import answer_sentences as say
from scope_ptz.planner.grammar.execution.camera_history import VisitedPlace, Whereabouts

Wanted = tuple[str, dict[str, Any]]


class Outcome(Protocol):
    """The outcome of a tool call: its result as JSON data, or ``error`` when it failed."""

    @property
    def result(self) -> dict[str, Any] | None: ...

    @property
    def error(self) -> str | None: ...


Run = Generator[Wanted, Outcome, Any]


@dataclass(frozen=True, slots=True)
class ImaginedOutcome:
    """The outcome of a call that was not made."""

    result: dict[str, Any]
    error: None = None


class HaltedError(Exception):
    """The run cannot continue; the message says why."""


@dataclass
class RunState:
    """The state of one run.

    Attributes:
        assume_met: Whether every condition counts as met, to show a plan without a camera.
        been: Where the camera was, according to the conversation.
        notes: The sentences of the answer.
        sources: Who answered the perception calls.
    """

    limits: Limits
    pose: Pose
    been: Whereabouts = field(default_factory=Whereabouts)
    assume_met: bool = False
    notes: list[str] = field(default_factory=list)
    sources: list[str] = field(default_factory=list)
    _missing: set[str] = field(default_factory=set)
    _trail: list[VisitedPlace] = field(default_factory=list)
    _winner: str | None = None
    _wandered: bool = False
    _sent_home: bool = False
    _last_count: int = -1
    _last_yes: bool = False

    def answer(self) -> str:
        """Return the answer: all notes, and the note about the sources."""
        text = " ".join(say.sentence(note) for note in self.notes if note) or "There was nothing to do."
        return text + say.source_text(self.sources)

    def _note(self, text: str) -> None:
        self.notes.append(text)

    def _call(self, tool: str, **arguments: Any) -> Run:
        outcome = yield tool, arguments
        result = outcome.result
        if outcome.error is None and result and isinstance(pose := result.get("pose"), dict):
            self.pose = Pose(pose["pan_deg"], pose["tilt_deg"], pose["zoom"])
        if result and (source := result.get("source")) and source not in self.sources:
            self.sources.append(source)
        return outcome

    def _moved(self, tool: str, **arguments: Any) -> Run:
        """Make a call that moves the camera. A failure ends the run, because the following steps would be meaningless."""
        outcome: Outcome = yield from self._call(tool, **arguments)
        if outcome.error is not None or outcome.result is None:
            raise HaltedError(f"I stopped because the camera did not do {tool}: {outcome.error or 'no result'}")
        return outcome.result

    def _looked(self, tool: str, **arguments: Any) -> Run:
        """Make a perception call and repeat it once after a failure. Return None, with a note, when both fail."""
        outcome: Outcome = yield from self._call(tool, **arguments)
        if outcome.error is not None:
            outcome = yield from self._call(tool, **arguments)
        if outcome.error is not None or outcome.result is None:
            self._note(f"I could not look ({tool} failed): {outcome.error or 'no result'}")
            return None
        return outcome.result

    def _needed(self, tool: str, **arguments: Any) -> Run:
        """Make a perception call that later steps depend on. A failure ends the run."""
        result = yield from self._looked(tool, **arguments)
        if result is None:
            raise HaltedError("I stopped there, because what comes next depends on it")
        return result

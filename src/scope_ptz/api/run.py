"""Finished runs, their tool calls, and the events of runs in progress."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from scope_ptz.agent.records import Called, CallFault, Decided, Ended, Outcome, Started
from scope_ptz.agent.timing import Timings
from scope_ptz.agent.trace import Trace, read_trace
from scope_ptz.errors import TraceError
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import CallTools, Usage

if TYPE_CHECKING:
    from PIL import Image

EventKind = Literal["started", "decided", "called", "ended"]


@dataclass(frozen=True, slots=True)
class CallResult:
    """A tool call in a run, with its result or error.

    Attributes:
        step: The planner step that made the call, counted from 1.
        name: Name of the tool.
        arguments: The arguments that the planner passed.
        result: The result of the tool as JSON data; None if the call failed.
        error: The reason why the call failed; None if it succeeded.
        fault: Kind of failure: "bad_call", "perception", "camera", "skipped" or "cancelled"; None if the call succeeded.
        pose: Pose of the camera after the call.
        duration_s: Duration of the call in seconds of wall-clock time.

    Example:
        >>> import scope_ptz
        >>> with scope_ptz.open("highway-works") as scope:
        ...     call = scope.ask("count the cones").calls[0]
        >>> call.name, call.result["count"]
        ('count_objects', 7)
    """

    step: int
    name: str
    arguments: Mapping[str, Any]
    result: Mapping[str, Any] | None
    error: str | None
    fault: CallFault | None
    pose: Pose
    duration_s: float

    @classmethod
    def of(cls, record: Called) -> CallResult:
        """Create a call result from a trace record."""
        outcome = record.outcome
        return cls(
            step=record.step,
            name=outcome.call.name,
            arguments=outcome.call.arguments,
            result=outcome.result,
            error=outcome.error,
            fault=record.fault,
            pose=record.pose.pose(),
            duration_s=record.timings.total_s,
        )

    @property
    def ok(self) -> bool:
        """Whether the call succeeded."""
        return self.error is None

    @property
    def message(self) -> str:
        """A sentence about the outcome: the result's message, or the error if the call failed."""
        return self.error if self.error is not None else str((self.result or {}).get("message", ""))

    def __str__(self) -> str:
        arguments = ", ".join(f"{name}={value!r}" for name, value in self.arguments.items())
        return f"{self.name}({arguments}) -> {self.message}"


class Run:
    """A finished run: the answer, the steps that led to it, and the pictures. A notebook displays it as HTML.

    ``Scope.ask`` returns runs, and ``Run.load`` reads one from a run folder.

    Example:
        >>> import scope_ptz
        >>> with scope_ptz.open("highway-works") as scope:
        ...     run = scope.ask("how many cones are there?")
        >>> run.outcome
        'answered'
        >>> print(run)
        I can see 7 cones in this view. (Source: the simulator's ground truth.)
    """

    def __init__(self, trace: Trace, ended: Ended, files: Mapping[str, bytes] | None = None) -> None:
        self._trace, self._ended, self._files = trace, ended, files

    @classmethod
    def load(cls, folder: str | PathLike[str]) -> Run:
        """Read a run from a run folder, such as those created by ``scope ask`` and ``open(runs_dir=...)``.

        Args:
            folder: The run folder, or the trace file in it.

        Returns:
            The run.

        Raises:
            TraceError: The trace is missing, damaged or incomplete.
        """
        trace = read_trace(Path(folder))
        if trace.ended is None:
            raise TraceError(
                f"The run in {folder} is incomplete, because the program was stopped. Inspect its steps with `scope replay`."
            )
        return cls(trace, trace.ended)

    @property
    def instruction(self) -> str:
        """The instruction that the run carried out."""
        return self._trace.started.instruction

    @property
    def answer(self) -> str:
        """The final text: the answer, the clarifying question, the reason for a refusal, or an error message (see ``outcome``)."""
        return self._ended.text

    @property
    def outcome(self) -> Outcome:
        """How the run ended.

        One of "answered", "clarification", "refused", "step_limit", "budget", "planner_error", "camera_error", "cancelled".
        """
        return self._ended.outcome

    @property
    def ok(self) -> bool:
        """Whether the run ended with an answer."""
        return self.outcome == "answered"

    @property
    def pose(self) -> Pose:
        """Final pose of the camera."""
        return self._ended.pose.pose()

    @property
    def start(self) -> Pose:
        """Initial pose of the camera."""
        return self._trace.started.pose.pose()

    @cached_property
    def calls(self) -> tuple[CallResult, ...]:
        """The tool calls in order, including those that failed."""
        return tuple(CallResult.of(record) for record in self._trace.calls)

    @property
    def planner(self) -> str:
        """Name of the planner."""
        return self._trace.started.planner

    @property
    def perception(self) -> str:
        """Name of the perception backend."""
        return self._trace.started.perception

    @property
    def note(self) -> str:
        """A sentence that describes a built-in perception backend, such as ground truth; empty for models."""
        return self._trace.started.labels.perception_note

    @property
    def timings(self) -> Timings:
        """Seconds of wall-clock time by component: ``planner_s``, ``perception_s``, ``camera_s``, ``render_s``, ``total_s``."""
        return self._ended.timings

    @property
    def usage(self) -> Usage:
        """Token counts of the planner: ``input_tokens``, ``output_tokens``, ``cached_tokens``."""
        return self._ended.usage

    @property
    def folder(self) -> Path | None:
        """The run folder, which contains the trace and the pictures; None if the run was stored in memory."""
        return self._trace.folder if self._files is None else None

    @cached_property
    def filmstrip(self) -> Image.Image:
        """The whole run in one picture, drawn on first use.

        Raises:
            TraceError: A picture of the run is missing or damaged.
        """
        from scope_ptz.agent.filmstrip import draw_filmstrip

        strip = draw_filmstrip(self._trace, self._files)
        if strip is None:
            raise TraceError("This run has no pictures, so there is no filmstrip.")
        return strip

    @property
    def pictures(self) -> tuple[str, ...]:
        """Names of all stored pictures, in order. ``picture(name)`` opens one."""
        if self._files is not None:
            return tuple(self._files)
        folder = self._trace.folder
        files = (path for part in ("frames", "pictures") for path in sorted((folder / part).glob("*")))
        return tuple(path.relative_to(folder).as_posix() for path in files)

    def picture(self, name: str) -> Image.Image:
        """Open a stored picture.

        Args:
            name: One of ``pictures``, or a name from the result of a call (``file`` of ``take_image``, or ``frames``).

        Returns:
            The picture.

        Raises:
            TraceError: There is no such picture.
        """
        from scope_ptz.agent.filmstrip import open_picture

        return open_picture(name, self._trace.folder, self._files)

    def __str__(self) -> str:
        return self.answer

    def __repr__(self) -> str:
        calls = f"{len(self.calls)} call{'' if len(self.calls) == 1 else 's'}"
        return f"<Run {self.outcome} after {calls}: {self.answer!r}>"

    def _repr_html_(self) -> str:
        from scope_ptz.api.notebook import run_html

        perception = self.note.rstrip(".") or f"perception {self.perception}"
        facts = (f"planner {self.planner}", perception, f"{self.timings.total_s:.1f} s")
        try:
            filmstrip: Image.Image | str = self.filmstrip
        except TraceError as error:
            filmstrip = str(error)
        return run_html(self.instruction, self.answer, self.outcome, facts, filmstrip, [_row(call) for call in self.calls])


@dataclass(frozen=True, slots=True)
class Event:
    """An event of a run in progress. ``print(event)`` shows it on one line.

    Attributes:
        kind: "started", "decided" (the planner chose tool calls or ended the run), "called" (a tool call finished) or "ended".
        text: A description of the event.
        call: The finished call of a "called" event; otherwise None.
        run: The finished run of an "ended" event; otherwise None.

    Example:
        >>> import scope_ptz
        >>> with scope_ptz.open("highway-works") as scope:
        ...     for event in scope.stream("count the cones"):
        ...         print(event.kind)
        started
        decided
        called
        decided
        ended
    """

    kind: EventKind
    text: str
    call: CallResult | None = None
    run: Run | None = field(default=None, repr=False)

    def __str__(self) -> str:
        return f"{self.kind:<8} {self.text}"


def create_event(record: Started | Decided | Called) -> Event:
    """Create the event for a trace record. The session itself creates the "ended" event, which contains the finished run."""
    match record:
        case Started():
            return Event("started", record.instruction)
        case Decided(decision=CallTools(calls=calls)):
            return Event("decided", ", ".join(call.name for call in calls))
        case Decided(decision=decision):
            return Event("decided", decision.kind)
        case Called():
            call = CallResult.of(record)
            return Event("called", str(call), call=call)


def _row(call: CallResult) -> tuple[str, str, str, str, str]:
    """Return the table row for a call in a notebook."""
    arguments = ", ".join(f"{name}={value}" for name, value in call.arguments.items())
    message = call.message if call.ok else f"failed: {call.message}"
    return str(call.step), call.name, arguments, message, f"{call.duration_s:.2f}"

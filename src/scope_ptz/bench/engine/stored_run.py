"""The data of a run that is stored in its sample for checks and judges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from scope_ptz.agent.records import RECORD, Called, Decided, Ended, Started
from scope_ptz.agent.trace import FILE_NAME, Trace
from scope_ptz.agent.trace_faults import record_faults
from scope_ptz.bench.scoring.episode import Episode, PresetViewpoints, episode_of
from scope_ptz.errors import TraceError

STORE = "scope"
"""Key for SCOPE's data in a sample's store."""
FRAME_WIDTH_PX, FRAME_HEIGHT_PX = 1280, 720
"""Size of the frames in every evaluation, in pixels. The minimum object sizes in tasks are defined for this frame size."""


def sample_name(task: str, epoch: int) -> str:
    """Return the name of a run's sample. ``task`` is the task's id."""
    return f"{task}#{epoch}"


@dataclass(frozen=True, slots=True)
class StoredRun:
    """The data of a run that is stored in its sample.

    Attributes:
        trace: The trace as JSON lines; empty if the run never began.
        presets: The viewpoints of the presets, by name.
        home: The viewpoint of the home preset.
        sees: Whether the planner received frames.
        pictures: References to the pictures in the sample's attachments, by the picture names in the trace.
        truths: The true count for each counting call, by the call's index; empty if not computed.
    """

    trace: str
    presets: Mapping[str, str]
    home: str
    sees: bool = False
    pictures: Mapping[str, str] = field(default_factory=dict)
    truths: Mapping[str, int | None] = field(default_factory=dict)

    def to_store(self) -> dict[str, Any]:
        """Convert the data to the JSON form in which a sample stores it."""
        return {
            "trace": self.trace, "presets": dict(self.presets), "home": self.home, "sees": self.sees,
            "pictures": dict(self.pictures), "truths": dict(self.truths),
        }  # fmt: skip

    @classmethod
    def from_store(cls, store: Any) -> StoredRun:
        """Read the data from a sample's store. Raises ``TraceError`` if the store does not contain it."""
        try:
            return cls(**{name: store[name] for name in ("trace", "presets", "home", "sees", "pictures", "truths")})
        except (KeyError, TypeError) as error:
            raise TraceError(
                "A sample of this log contains no run, so the log is not from this benchmark. Use a log from `scope bench run`."
            ) from error

    @property
    def places(self) -> PresetViewpoints:
        """The viewpoints of the presets and the home position."""
        return PresetViewpoints(self.presets, self.home)

    def episode(self, trace: Trace) -> Episode:
        """Build the episode of the run, which is the input for the checks."""
        return episode_of(trace, self.places, planner_sees=self.sees, keeps_files=False)


def trace_of(text: str, folder: Path) -> Trace | None:
    """Parse a trace from JSON lines; return None if the run never began.

    Args:
        text: The JSON lines.
        folder: The folder of the trace, for error messages.

    Raises:
        TraceError: The trace is damaged.
    """
    try:
        # Strings in JSON may contain other line separators, which ``splitlines`` would split.
        records = [RECORD.validate_json(line) for line in text.split("\n") if line]
    except ValidationError as error:
        raise TraceError(f"The trace of a run in {folder} is damaged: {error.errors(include_url=False)[0]['msg']}.") from error
    if not records:
        return None
    first, last = records[0], records[-1]
    if not isinstance(first, Started):
        raise TraceError(f"The trace of a run in {folder} is damaged: it does not begin with the header of a {FILE_NAME}.")
    if fault := next(record_faults(records), None):
        raise TraceError(f"The trace of a run in {folder} is damaged: {fault}.")
    return Trace(
        folder=folder,
        started=first,
        decisions=tuple(r for r in records if isinstance(r, Decided)),
        calls=tuple(r for r in records if isinstance(r, Called)),
        ended=last if isinstance(last, Ended) else None,
    )

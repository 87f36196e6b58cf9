"""Recorded runs of operators with their feedback. They show a model what people ask of a camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.agent.trace import FILE_NAME, Trace, read_trace
from scope_ptz.errors import InputError

MOST_RUNS, MAX_REPLY_CHARS = 12, 300  # runs in a prompt, and characters of each text in it


class Feedback(BaseModel):
    """A line of a feedback file. ``run`` is the name of a run folder."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    run: str = Field(min_length=1, max_length=200)
    rating: Literal["good", "bad"]
    note: str = ""


@dataclass(frozen=True, slots=True)
class OperatorRun:
    """A recorded run and the feedback on it."""

    trace: Trace
    feedback: Feedback | None

    def summary(self) -> dict[str, Any]:
        """Return the run in short, as data for a prompt."""
        ended = self.trace.ended
        return {
            "asked": self.trace.started.instruction[:MAX_REPLY_CHARS],
            "calls": [{call.outcome.call.name: call.outcome.call.arguments} for call in self.trace.calls][:10],
            "ended": f"{ended.outcome}: {ended.text[:MAX_REPLY_CHARS]}" if ended else "cut off",
            "operator said": f"{self.feedback.rating}: {self.feedback.note[:MAX_REPLY_CHARS]}" if self.feedback else "nothing",
        }


def read_runs(folder: Path | None, feedback: Path | None) -> list[OperatorRun]:
    """Read the runs for a prompt, those with feedback first.

    Args:
        folder: Folder of run folders.
        feedback: JSONL file with feedback.

    Raises:
        InputError: The folder or the feedback cannot be read, or the feedback is about a run that does not exist.
    """
    comments = {row.run: row for row in _feedback(feedback)} if feedback is not None else {}
    if folder is None:
        if comments:
            raise InputError("Feedback needs the runs that it is about. Name their folder with --runs.")
        return []
    if not folder.is_dir():
        raise InputError(f"There is no folder of runs at {folder}.")
    names = sorted(path.name for path in folder.iterdir() if (path / FILE_NAME).is_file())
    if unknown := sorted(set(comments) - set(names)):
        raise InputError(f"The feedback is about the run '{unknown[0]}', which is not in {folder}.")
    chosen = sorted(names, key=lambda name: (name not in comments, name))[:MOST_RUNS]
    return [OperatorRun(read_trace(folder / name), comments.get(name)) for name in chosen]


def _feedback(path: Path) -> Sequence[Feedback]:
    try:
        lines = path.read_text("utf-8").splitlines()
    except OSError as error:
        raise InputError(f"The feedback {path} cannot be read: {error.strerror}.") from error
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            if line.strip():
                rows.append(Feedback.model_validate_json(line))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            raise InputError(f"{path}, line {number}: {'.'.join(map(str, first['loc'])) or 'row'}: {first['msg']}.") from error
    return rows

"""Operators' recorded runs with feedback, which show a model what instructions people give to a camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.agent.trace import FILE_NAME, Trace, read_trace
from scope_ptz.errors import InputError

MAX_RUNS, MAX_TEXT_CHARS = 12, 300  # maximum number of runs in a prompt, and of characters in each of their texts


class Feedback(BaseModel):
    """Feedback on a run, as one line of a feedback file. ``run`` is the name of the run folder."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    run: str = Field(min_length=1, max_length=200)
    rating: Literal["good", "bad"]
    note: str = ""


@dataclass(frozen=True, slots=True)
class OperatorRun:
    """A recorded run, with any feedback on it."""

    trace: Trace
    feedback: Feedback | None

    def summary(self) -> dict[str, Any]:
        """Return a summary of the run as JSON data for a prompt."""
        ended = self.trace.ended
        return {
            "asked": self.trace.started.instruction[:MAX_TEXT_CHARS],
            "calls": [{call.outcome.call.name: call.outcome.call.arguments} for call in self.trace.calls][:10],
            "ended": f"{ended.outcome}: {ended.text[:MAX_TEXT_CHARS]}" if ended else "cut off",
            "operator said": f"{self.feedback.rating}: {self.feedback.note[:MAX_TEXT_CHARS]}" if self.feedback else "nothing",
        }


def read_runs(folder: Path | None, feedback: Path | None) -> list[OperatorRun]:
    """Read at most ``MAX_RUNS`` runs for a prompt, those with feedback first.

    Args:
        folder: Folder that contains run folders; None for no runs.
        feedback: JSONL file with feedback; None for no feedback.

    Raises:
        InputError: The folder or the feedback cannot be read, or the feedback is about a run that does not exist.
    """
    comments = {row.run: row for row in _read_feedback(feedback)} if feedback is not None else {}
    if folder is None:
        if comments:
            raise InputError("Feedback needs the recorded runs. Specify their folder with --runs.")
        return []
    if not folder.is_dir():
        raise InputError(f"The runs folder {folder} does not exist. Correct --runs.")
    names = sorted(path.name for path in folder.iterdir() if (path / FILE_NAME).is_file())
    if unknown := sorted(set(comments) - set(names)):
        raise InputError(f"The feedback is about the run '{unknown[0]}', which is not in {folder}.")
    chosen = sorted(names, key=lambda name: (name not in comments, name))[:MAX_RUNS]
    return [OperatorRun(read_trace(folder / name), comments.get(name)) for name in chosen]


def _read_feedback(path: Path) -> Sequence[Feedback]:
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

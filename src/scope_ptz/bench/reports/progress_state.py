"""The progress of an evaluation, as its progress files store it: counts, the score so far, and the running tasks."""

from __future__ import annotations

from datetime import datetime

from pydantic import BaseModel, ConfigDict

STATE_FILE = "progress.json"
"""The file with the current ``ProgressState``."""
TRIALS_FILE = "trials.jsonl"
"""The file with the finished runs, one ``Trial`` per line."""
LOCK_FILE = "progress.lock"
"""The file that an evaluation keeps locked while it runs."""


class _State(BaseModel):
    model_config = ConfigDict(frozen=True)


class Score(_State):
    """A fraction of correct runs with its 95% interval, clustered by viewpoint. The limits are None if they are unknown."""

    value: float
    low: float | None
    high: float | None


class CategoryProgress(_State):
    """The finished runs of one category. ``accuracy`` excludes infrastructure failures; None if no run is scored."""

    category: str
    runs: int
    correct: int
    accuracy: float | None


class RunningTask(_State):
    """A task in progress: its id, its instruction, and the time at which it began."""

    task: str
    instruction: str
    since: datetime


class ProgressState(_State):
    """The progress of an evaluation.

    Attributes:
        pid: The id of the process that runs it.
        runs: Total number of runs, including finished ones.
        done: Number of finished runs.
        correct: Number of correct runs.
        incorrect: Number of incorrect runs.
        unscored: Number of runs whose answer could not be parsed.
        broken: Number of runs with an infrastructure failure.
        micro: Fraction of correct runs.
        macro: Mean of the fractions of the categories.
        categories: The finished runs by category.
        running: The tasks in progress.
        seconds_left: Estimated remaining time in seconds; None until the first run has finished.
        notes: Messages that the evaluation reported.
        log: Name of the log in the log folder; empty until the evaluation has ended.
        finished: Whether the evaluation completed, without being cancelled.
    """

    pid: int
    runs: int
    done: int = 0
    correct: int = 0
    incorrect: int = 0
    unscored: int = 0
    broken: int = 0
    micro: Score | None = None
    macro: Score | None = None
    categories: tuple[CategoryProgress, ...] = ()
    running: tuple[RunningTask, ...] = ()
    seconds_left: float | None = None
    notes: tuple[str, ...] = ()
    log: str = ""
    finished: bool = False

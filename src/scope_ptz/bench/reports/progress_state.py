"""The progress of an evaluation as stored in its progress files: counts, current scores and running tasks."""

from __future__ import annotations

from datetime import datetime

from pydantic import BaseModel, ConfigDict

STATE_FILE = "progress.json"
"""Name of the file with the current ``ProgressState``."""
TRIALS_FILE = "trials.jsonl"
"""Name of the file with the finished runs, one ``Trial`` per line."""
LOCK_FILE = "progress.lock"
"""Name of the file that an evaluation keeps locked while it is running."""


class _State(BaseModel):
    model_config = ConfigDict(frozen=True)


class Score(_State):
    """A fraction of correct runs with its 95% interval, clustered by viewpoint. Unknown limits are None."""

    value: float
    low: float | None
    high: float | None


class CategoryProgress(_State):
    """The finished runs in a category. ``accuracy`` excludes infrastructure failures, and is None if no run is scored."""

    category: str
    runs: int
    correct: int
    accuracy: float | None


class RunningTask(_State):
    """A task in progress: the id, the instruction and the start time."""

    task: str
    instruction: str
    since: datetime


class ProgressState(_State):
    """The progress of an evaluation.

    Attributes:
        pid: Id of the process that runs the evaluation.
        runs: Total number of runs, including finished ones.
        done: Number of finished runs.
        correct: Number of correct runs.
        incorrect: Number of incorrect runs.
        unscored: Number of runs whose answer could not be parsed.
        broken: Number of runs with an infrastructure failure.
        micro: Micro accuracy: the fraction of correct runs.
        macro: Macro accuracy: the mean of the accuracies in the categories.
        categories: The finished runs by category.
        running: The tasks in progress.
        seconds_left: Estimated remaining time in seconds; None until the first run has finished.
        notes: Messages from the evaluation.
        log: Name of the log in the log folder; empty until the evaluation has ended.
        finished: Whether the evaluation was completed rather than cancelled.
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

"""Read the steps and pictures of individual runs from an evaluation's log."""

from __future__ import annotations

import threading
from collections import OrderedDict
from typing import TYPE_CHECKING, Any

from scope_ptz.agent.trace import picture_names
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.errors import TraceError, UnknownNameError
from scope_ptz.serve.site.benchmark.evaluation_folder import EvaluationFolder, modification_time_s
from scope_ptz.serve.site.benchmark.splits import missing_packages
from scope_ptz.serve.site.marks import call_for_picture, draw_marks, marks_of

if TYPE_CHECKING:
    from scope_ptz.agent.trace import Trace
    from scope_ptz.bench.engine.sample_files import SampleFiles

MAX_CACHED_RUNS = 4
"""Maximum number of runs to cache in memory, with their pictures."""


class Trajectories:
    """Reads runs from evaluations.

    The most recently read runs are cached, because clients request each of a run's pictures separately.
    """

    def __init__(self) -> None:
        self._cache: OrderedDict[tuple[str, str, float], SampleFiles] = OrderedDict()
        self._lock = threading.Lock()

    def trace(self, folder: EvaluationFolder, trial: Trial) -> Trace:
        """Return a run's trace.

        Raises:
            TraceError: The log does not contain the run yet, or a package is missing.
        """
        return self._sample(folder, trial).trace

    def picture(self, folder: EvaluationFolder, trial: Trial, name: str, *, marks: bool) -> bytes:
        """Return a picture from a run as JPEG. With ``marks``, draw the detections on it.

        Raises:
            UnknownNameError: The run has no such picture.
            TraceError: The log does not contain the picture, or a package is missing.
        """
        sample = self._sample(folder, trial)
        if name not in picture_names(sample.trace):
            raise UnknownNameError("picture", name[:80], ())
        data = sample.picture(name)
        if data is None:
            raise TraceError("The log does not contain this picture.")
        return draw_marks(data, marks_of(call_for_picture(sample.trace, name), name)) if marks else data

    def _sample(self, folder: EvaluationFolder, trial: Trial) -> SampleFiles:
        if missing := missing_packages():
            raise TraceError(missing)
        from scope_ptz.bench.engine.sample_files import open_sample  # imported late: needs the bench extra

        log = folder.newest_log()
        if log is None:
            raise TraceError("The evaluation has no log yet.")
        key = (folder.path.name, trial.sample, modification_time_s(log))
        with self._lock:
            if key in self._cache:
                self._cache.move_to_end(key)
                return self._cache[key]
            try:
                sample = open_sample(log, trial.sample)
            except TraceError as error:
                raise TraceError(
                    "The steps and pictures of this run are not in the log yet. The log is written after every few runs; if the "
                    "evaluation was interrupted, resume it to add them."
                ) from error
            self._cache[key] = sample
            while len(self._cache) > MAX_CACHED_RUNS:
                self._cache.popitem(last=False)
            return sample


def steps_of(trace: Trace) -> list[dict[str, Any]]:
    """Return a run's tool calls as JSON data: tool, arguments, message, error flag, duration and pictures."""
    names = picture_names(trace)
    steps = []
    for position, call in enumerate(trace.calls):
        outcome = call.outcome
        result = outcome.result or {}
        pictures = [
            {"name": name, "marks": len(marks_of(call_for_picture(trace, name), name))}
            for name, call_position in names.items()
            if call_position == position
        ]
        steps.append(
            {
                "tool": outcome.call.name,
                "arguments": outcome.call.arguments,
                "message": outcome.error if outcome.error is not None else str(result.get("message", "")),
                "failed": outcome.error is not None,
                "seconds": call.timings.total_s,
                "pictures": pictures,
            }
        )
    return steps

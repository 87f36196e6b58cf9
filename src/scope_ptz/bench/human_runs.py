"""The human baseline: score and store runs by people with the same checks and records as runs by models."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from scope_ptz.agent.timing import Timings
from scope_ptz.agent.trace import Trace, picture_path, read_trace
from scope_ptz.bench.scoring.episode import PresetViewpoints, episode_of
from scope_ptz.bench.scoring.error_modes import error_mode
from scope_ptz.bench.scoring.trials import CheckRecord, Evaluation, ModelCard, RunCard, Trial
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.files import digest_of
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.errors import InputError, OutputError, TraceError
from scope_ptz.simulator.models import SceneFile
from scope_ptz.version import __version__

RESULT_FILE = "evaluation.json"
"""File name for the result of a session."""
DIGEST_CHARS = 16
"""Length of the tasks' digest in hexadecimal characters."""


def human_run_card(person_name: str, split: str, tasks: Sequence[Task], started: str, max_steps: int) -> RunCard:
    """Create the run card for a session by a person, who is both planner and perception."""
    person = ModelCard(name=person_name, provider="person")
    return RunCard(
        run_id=f"human-{person_name}",
        started=started,
        package_version=__version__,
        engine_version="none",
        dataset=tasks[0].dataset,
        dataset_digest=digest_of(tasks)[:DIGEST_CHARS],
        split=split,
        planner=person,
        perception=person,
        max_steps=max_steps,
        contended=False,
    )


def human_trial(task: Task, scene: SceneFile, trace: Trace, sample: str) -> Trial:
    """Score a finished run with the task's checks. The person saw the camera's view before every decision."""
    episode = episode_of(trace, PresetViewpoints.of(scene), planner_sees=True)
    verdict, ended = score_episode(task, episode), trace.ended
    viewpoint = next(preset.viewpoint for preset in scene.presets if preset.name == task.preset)
    return Trial(
        task=facts_of(task, viewpoint),
        sample=sample,
        headline=verdict.headline,
        reason=verdict.reason,
        error_mode=error_mode(task, episode, verdict=verdict),
        checks=tuple(CheckRecord(name=c.name, passed=c.passed, reason=c.reason) for c in verdict.checks),
        collateral=verdict.moved_needlessly,
        outcome=episode.outcome,
        answer=episode.answer,
        steps=ended.steps if ended else len(trace.decisions),
        tool_calls=dict(Counter(call.outcome.call.name for call in trace.calls if call.fault != "skipped")),
        bad_calls=sum(call.fault == "bad_call" for call in trace.calls),
        perception_failures=sum(call.fault == "perception" for call in trace.calls),
        timings=ended.timings if ended else Timings(),
    )


@dataclass(frozen=True, slots=True)
class StoredHumanRun:
    """A run by a person: its trace, and the pictures in its folder."""

    trace: Trace

    def picture(self, name: str) -> bytes | None:
        """Return a picture by its name in the trace; None if it does not exist.

        Raises:
            TraceError: The name refers to a path outside the folder.
        """
        path = picture_path(self.trace.folder, name)
        try:
            return path.read_bytes()
        except OSError:
            return None


def open_run(result: Path, sample: str) -> StoredHumanRun:
    """Open a run by name (``Trial.sample``). The run folder is next to the result file.

    Raises:
        TraceError: The run cannot be read, or its name refers to a path outside the folder.
    """
    folder = result.parent / sample
    if sample in {"", ".", ".."} or Path(sample).name != sample:
        raise TraceError(f"{result} is damaged: it names the run '{sample}', which is outside its folder.")
    return StoredHumanRun(read_trace(folder))


def write_result(evaluation: Evaluation, folder: Path) -> Path:
    """Write the result of a session atomically, so that an interruption does not damage the previous result.

    Raises:
        OutputError: The file cannot be written.
    """
    path, new_file = folder / RESULT_FILE, folder / f"{RESULT_FILE}.new"
    try:
        new_file.write_text(evaluation.model_dump_json(indent=1) + "\n", "utf-8")
        new_file.replace(path)
    except OSError as error:
        raise OutputError(f"The result {path} cannot be written: {error.strerror}.") from error
    return path


def read_result(path: Path) -> Evaluation:
    """Read a result that ``scope bench human`` wrote.

    Raises:
        InputError: The file cannot be read or is not a result.
    """
    try:
        return Evaluation.model_validate_json(path.read_bytes())
    except OSError as error:
        raise InputError(f"The result {path} cannot be read: {error.strerror}.") from error
    except ValidationError as error:
        first_error = error.errors(include_url=False)[0]
        field = ".".join(map(str, first_error["loc"]))
        raise InputError(f"{path} is not a result of 'scope bench human': {field}: {first_error['msg']}.") from error

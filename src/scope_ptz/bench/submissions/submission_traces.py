"""Prepare traces for a submission, read them with a size limit, and score them again."""

from __future__ import annotations

import base64
import json
import zlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.stored_run import StoredRun, sample_name
from scope_ptz.bench.engine.token_costs import cost_usd
from scope_ptz.bench.engine.traces.scored_trials import published_task_entry, scored_trial, with_packaged_presets
from scope_ptz.bench.engine.traces.verification import RunToVerify
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.submissions.submission import Header, Places, Run, TrialLine, public_settings, remove_secrets, trial_line
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.builtin_names import GROUND_TRUTH, NOISY_SOURCE
from scope_ptz.errors import InputError

MAX_TRACE_BYTES = 20_000_000
"""Maximum size of an uncompressed trace in bytes."""
_COMPUTED_FIELDS = (
    "headline", "error_mode", "checks", "outcome", "answer", "steps", "tool_calls", "bad_calls", "perception_failures",
    "collateral", "input_tokens", "output_tokens", "cost_usd", "times",
)  # fmt: skip
"""Line fields that are computed from the trace, the most important first."""
_NONBLOCKING_FINDINGS = frozenset({"score-differs", "task-differs", "card-differs"})
"""Kinds of findings that do not affect the traces, so that the log can still be submitted."""


@dataclass(frozen=True, slots=True)
class PublicRuns:
    """The published runs of an evaluation, for a submission in format 2.

    Attributes:
        evaluation: The evaluation, scored from the published traces.
        runs: The runs by sample name.
        places: The viewpoints of the presets, by scene.
    """

    evaluation: Evaluation
    runs: Mapping[str, Run]
    places: Mapping[str, Places]


def publish_runs(evaluation: Evaluation, stored_runs: Iterable[RunToVerify]) -> PublicRuns:
    """Remove secrets and addresses from the runs of an evaluation, and score the evaluation from these runs.

    Args:
        evaluation: The evaluation, as read from its log.
        stored_runs: The runs in the log.

    Raises:
        InputError: Runs in the log are missing, repeated or damaged.
    """
    blocking = [finding for finding in evaluation.findings if finding.kind not in _NONBLOCKING_FINDINGS]
    if blocking:
        first = blocking[0]
        raise InputError(
            f"The log {evaluation.log} contradicts its traces, so it cannot be submitted: {first.sample or 'the log'}: "
            f"{first.detail}. Run the evaluation again."
        )
    trials = {trial.sample: trial for trial in evaluation.trials}
    runs, places = dict[str, Run](), dict[str, Places]()
    for run in stored_runs:
        if run.name not in trials or not run.stored_run.trace:
            continue
        public = replace(with_packaged_presets(run.stored_run, run.entry.world), trace=public_trace(run.stored_run.trace))
        places[run.entry.world] = Places(presets=dict(public.presets), home=public.home)
        runs[run.name] = Run(trace=pack_trace(public.trace), sees=public.sees, true_counts=dict(public.truths))
        original = trials[run.name]
        trial, _ = scored_trial(run.entry, public, run.epoch, Path(evaluation.log), original.judgements, failed=True)
        price = cost_usd(evaluation.card, trial.input_tokens, trial.output_tokens)
        trials[run.name] = trial.model_copy(update={"cost_usd": price}) if original.scored_by == "checks" else original
    return PublicRuns(evaluation.model_copy(update={"trials": tuple(trials.values())}), runs, places)


def public_trace(text: str) -> str:
    """Remove everything that the checks do not need from a trace: secrets, addresses, reasoning and debugging details."""
    return "".join(json.dumps(_public_record(json.loads(line))) + "\n" for line in text.split("\n") if line)


def _public_record(record: dict[str, Any]) -> dict[str, Any]:
    if "planner_details" in record:
        record["planner_details"] = public_settings(record["planner_details"])
    if "detail" in record:
        record["detail"] = ""
    if isinstance(record.get("decision"), dict):
        record["decision"]["reasoning"] = ""
    for reply in record.get("replies") or ():
        if isinstance(reply.get("result"), dict) and reply["result"].get("source") not in (GROUND_TRUTH, NOISY_SOURCE):
            reply["result"]["raw"] = ""
    public: dict[str, Any] = _remove_secrets(record)
    return public


def _remove_secrets(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _remove_secrets(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_remove_secrets(item) for item in value]
    return remove_secrets(value) if isinstance(value, str) else value


def pack_trace(trace: str) -> str:
    """Compress a trace with zlib, and encode it in base64."""
    return base64.b64encode(zlib.compress(trace.encode(), 9)).decode("ascii")


def unpack_trace(trace: str) -> str:
    """Decode and decompress a trace.

    Raises:
        InputError: The text is not valid base64, the data is damaged, or the trace is larger than ``MAX_TRACE_BYTES``.
    """
    try:
        stream = zlib.decompressobj()
        data = stream.decompress(base64.b64decode(trace, validate=True), MAX_TRACE_BYTES)
        if not stream.eof:
            raise InputError("The trace is incomplete or too large.")
        return data.decode("utf-8")
    except (ValueError, zlib.error) as error:
        raise InputError(f"The trace is damaged: {error}.") from error


def runs_in(header: Header, lines: Sequence[TrialLine], tasks: Mapping[str, Task]) -> dict[tuple[str, int], RunToVerify | str]:
    """Return the runs of a submission by task and epoch. For a run that cannot be read, return the reason instead."""
    runs: dict[tuple[str, int], RunToVerify | str] = {}
    for line in lines:
        task = tasks.get(line.task)
        if task is None or line.run is None:
            continue
        places = header.places.get(task.world)
        entry = _entry(task, places)
        try:
            stored_run = StoredRun(
                unpack_trace(line.run.trace), places.presets if places else {}, places.home if places else "", line.run.sees,
                truths=line.run.true_counts,
            )  # fmt: skip
        except InputError as error:
            runs[line.task, line.epoch] = str(error).rstrip(".")
            continue
        runs[line.task, line.epoch] = RunToVerify(entry, line.epoch, with_packaged_presets(stored_run, entry.world))
    return runs


def _entry(task: Task, places: Places | None) -> Entry:
    """Return the entry for a task. For a private task, the viewpoint of the preset is taken from the submission."""
    published = published_task_entry(task.id)
    if published is not None and published.task == task:
        return published
    viewpoint = places.presets.get(task.preset, "") if places is not None else ""
    return Entry(facts=facts_of(task, viewpoint), world=task.world, time_s=task.time_s, task=task)


def trace_line_faults(header: Header, line: TrialLine, run: RunToVerify | str | None) -> Iterator[str]:
    """Yield the faults in a line of format 2: a missing or damaged trace, or fields that contradict the trace."""
    if isinstance(run, str):
        yield f"its trace cannot be read: {run}"
        return
    if run is None:
        if line.headline != "infrastructure" or line.outcome is not None:
            yield "it has no trace"
        return
    trial, fault = scored_trial(run.entry, run.stored_run, line.epoch, Path(line.task), failed=line.headline == "infrastructure")
    if fault is not None:
        yield f"its trace contradicts itself or its task: {fault.detail}"
        return
    yield from _line_differences(line, _computed_line(header, trial))


def _computed_line(header: Header, trial: Trial) -> TrialLine:
    price = cost_usd(header.card, trial.input_tokens, trial.output_tokens)
    return trial_line(trial.model_copy(update={"cost_usd": price}))


def _line_differences(line: TrialLine, computed: TrialLine) -> Iterator[str]:
    differing = [name for name in _COMPUTED_FIELDS if getattr(line, name) != getattr(computed, name)]
    if line.scored_by == "judge":
        differing = [name for name in differing if name not in ("headline", "error_mode", "checks", "collateral")]
    for name in differing:
        stated, found = _short_text(getattr(line, name)), _short_text(getattr(computed, name))
        yield f"{name} does not follow from its trace: stated {stated}, the trace gives {found}"


def _short_text(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 80 else text[:77] + "..."


def copied_trace_faults(lines: Sequence[TrialLine]) -> Iterator[str]:
    """Yield a fault for each trace that occurs in several trials."""
    uses = Counter(line.run.trace for line in lines if line.run is not None)
    for trace, number in uses.items():
        if number > 1:
            names = [sample_name(line.task, line.epoch) for line in lines if line.run is not None and line.run.trace == trace]
            yield f"{', '.join(names[:3])} have the same trace"

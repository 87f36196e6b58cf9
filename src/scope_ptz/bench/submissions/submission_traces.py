"""The traces of a submission: written without secrets and addresses, read with a limit on their size, and scored again."""

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
from scope_ptz.bench.engine.traces.scored_trials import entry_of_published, published_run, scored_trial
from scope_ptz.bench.engine.traces.verification import RunToVerify
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.submissions.submission import Header, Places, Run, TrialLine, public_settings, trial_line, without_secrets
from scope_ptz.bench.tasks.task import Task
from scope_ptz.bench.tasks.task_wording import facts_of
from scope_ptz.builtin_names import GROUND_TRUTH, NOISY_SOURCE
from scope_ptz.errors import InputError

MAX_TRACE_BYTES = 20_000_000
"""Maximum size of a trace without compression, in bytes."""
_COMPUTED = (
    "headline", "error_mode", "checks", "outcome", "answer", "steps", "tool_calls", "bad_calls", "perception_failures",
    "collateral", "input_tokens", "output_tokens", "cost_usd", "times",
)  # fmt: skip
"""Fields of a line that follow from its trace, the most important first."""
_USABLE_FINDINGS = frozenset({"score-differs", "task-differs", "card-differs"})
"""Kinds of findings about a log that concern only what the log states besides its traces."""


@dataclass(frozen=True, slots=True)
class PublicRuns:
    """The runs of an evaluation for a submission of format 2.

    Attributes:
        evaluation: The evaluation, scored from the published traces.
        runs: The runs by the names of their samples.
        places: The viewpoints of the presets, by scene.
    """

    evaluation: Evaluation
    runs: Mapping[str, Run]
    places: Mapping[str, Places]


def public_runs(evaluation: Evaluation, stored: Iterable[RunToVerify]) -> PublicRuns:
    """Return the runs of an evaluation without secrets and addresses, and the evaluation scored from them.

    Args:
        evaluation: The evaluation, as read from its log.
        stored: The runs of the log.

    Raises:
        InputError: The log has missing, repeated or damaged runs.
    """
    unusable = [finding for finding in evaluation.findings if finding.kind not in _USABLE_FINDINGS]
    if unusable:
        first = unusable[0]
        raise InputError(
            f"The log {evaluation.log} contradicts its traces, so it cannot be submitted: {first.sample or 'the log'}: "
            f"{first.detail}. Run the evaluation again."
        )
    trials = {trial.sample: trial for trial in evaluation.trials}
    runs, places = dict[str, Run](), dict[str, Places]()
    for run in stored:
        if run.name not in trials or not run.stored_run.trace:
            continue
        public = replace(published_run(run.stored_run, run.entry.world), trace=public_trace(run.stored_run.trace))
        places[run.entry.world] = Places(presets=dict(public.presets), home=public.home)
        runs[run.name] = Run(trace=packed(public.trace), sees=public.sees, true_counts=dict(public.truths))
        before = trials[run.name]
        trial, _ = scored_trial(run.entry, public, run.epoch, Path(evaluation.log), before.judgements, failed=True)
        price = cost_usd(evaluation.card, trial.input_tokens, trial.output_tokens)
        trials[run.name] = trial.model_copy(update={"cost_usd": price}) if before.scored_by == "checks" else before
    return PublicRuns(evaluation.model_copy(update={"trials": tuple(trials.values())}), runs, places)


def public_trace(text: str) -> str:
    """Return a trace without secrets, addresses, reasoning and details for debugging. The checks need none of them."""
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
    public: dict[str, Any] = _without_secrets(record)
    return public


def _without_secrets(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _without_secrets(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_without_secrets(one) for one in value]
    return without_secrets(value) if isinstance(value, str) else value


def packed(trace: str) -> str:
    """Return a trace compressed with zlib, in base64."""
    return base64.b64encode(zlib.compress(trace.encode(), 9)).decode("ascii")


def unpacked(trace: str) -> str:
    """Return a trace from its compressed form.

    Raises:
        InputError: The text is not base64, the data are damaged, or the trace is larger than ``MAX_TRACE_BYTES``.
    """
    try:
        stream = zlib.decompressobj()
        data = stream.decompress(base64.b64decode(trace, validate=True), MAX_TRACE_BYTES)
        if not stream.eof:
            raise InputError("The trace is cut off or too large.")
        return data.decode("utf-8")
    except (ValueError, zlib.error) as error:
        raise InputError(f"The trace is damaged: {error}.") from error


def runs_in(header: Header, lines: Sequence[TrialLine], tasks: Mapping[str, Task]) -> dict[tuple[str, int], RunToVerify | str]:
    """Return the runs of a submission by task and epoch; for a run that cannot be read, the reason."""
    runs: dict[tuple[str, int], RunToVerify | str] = {}
    for line in lines:
        task = tasks.get(line.task)
        if task is None or line.run is None:
            continue
        places = header.places.get(task.world)
        entry = _entry(task, places)
        try:
            stored = StoredRun(
                unpacked(line.run.trace), places.presets if places else {}, places.home if places else "", line.run.sees,
                truths=line.run.true_counts,
            )  # fmt: skip
        except InputError as error:
            runs[line.task, line.epoch] = str(error).rstrip(".")
            continue
        runs[line.task, line.epoch] = RunToVerify(entry, line.epoch, published_run(stored, entry.world))
    return runs


def _entry(task: Task, places: Places | None) -> Entry:
    """Return the entry of a task. For a task that is not published, the file states the viewpoint of the preset."""
    published = entry_of_published(task.id)
    if published is not None and published.task == task:
        return published
    viewpoint = places.presets.get(task.preset, "") if places is not None else ""
    return Entry(facts=facts_of(task, viewpoint), world=task.world, time_s=task.time_s, task=task)


def trace_line_faults(header: Header, line: TrialLine, run: RunToVerify | str | None) -> Iterator[str]:
    """Yield the faults of a line of format 2: its trace is missing or damaged, or it states what does not follow from its trace."""
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
    differing = [name for name in _COMPUTED if getattr(line, name) != getattr(computed, name)]
    if line.scored_by == "judge":
        differing = [name for name in differing if name not in ("headline", "error_mode", "checks", "collateral")]
    for name in differing:
        stated, found = _text(getattr(line, name)), _text(getattr(computed, name))
        yield f"{name} does not follow from its trace: stated {stated}, the trace gives {found}"


def _text(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 80 else text[:77] + "..."


def copied_traces(lines: Sequence[TrialLine]) -> Iterator[str]:
    """Yield a fault for each trace that several trials share."""
    uses = Counter(line.run.trace for line in lines if line.run is not None)
    for trace, number in uses.items():
        if number > 1:
            names = [sample_name(line.task, line.epoch) for line in lines if line.run is not None and line.run.trace == trace]
            yield f"{', '.join(names[:3])} have the same trace"

"""Write submissions for a public leaderboard: a header and one JSON line per trial, without keys or addresses.

Format 1 contains only the trials. Format 2 also contains the traces, so that the checks can be run again and the calls repeated.
The schema of a line is ``data/submission.schema.json``; docs/reports.md describes its validation. The docstrings of the line models
are part of that schema and change only with its version.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Protocol, get_args

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from scope_ptz.bench.reports.display_names import split_name
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import CheckRecord, Count, Evaluation, ModelCard, RunCard, Seconds, Trial
from scope_ptz.bench.scoring.verdict import Headline
from scope_ptz.bench.tasks.task import CANARY, Category, ToolName
from scope_ptz.errors import InputError, OutputError

MOST_ANSWER = 8_000
"""Maximum length of a published answer in characters. The published schema refers to it by this name."""
Line = Annotated[str, Field(max_length=500)]
MAX_TRACE_CHARS = 2_000_000
"""Maximum length of a compressed trace, in base64 characters."""
TRUNCATION_MARK = " [cut]"
"""Suffix of a truncated answer."""
TOOLS = frozenset(get_args(ToolName))
UNKNOWN_TOOL = "unknown"
_UNCHANGED_FIELDS = (
    "epoch", "headline", "scored_by", "error_mode", "outcome", "steps", "bad_calls", "perception_failures", "collateral",
    "input_tokens", "output_tokens", "cost_usd",
)  # fmt: skip
"""Trial fields that are published unchanged."""
_SECRET = re.compile(
    r"(?:\b(?:sk|pk|rk)-[A-Za-z0-9_-]{16,}|\bhf_[A-Za-z0-9]{16,}|\bgh[pousr]_[A-Za-z0-9]{20,}|\bAKIA[A-Z0-9]{16}\b"
    r"|\beyJ[\w-]{10,}\.[\w-]{10,}\.|bearer\s+[\w.~+/-]{12,}|://[^/\s:@]+:[^/\s@]+@|-----BEGIN [A-Z ]*PRIVATE KEY)",
    re.IGNORECASE,
)
_ADDRESS = re.compile(r"[a-z][a-z0-9+.-]*://[^\s\"'<>]+", re.IGNORECASE)
_SECRET_NAMES = re.compile(r"key|token$|secret|password|authori[sz]ation|cookie|credential", re.IGNORECASE)


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Totals(_Part):
    """Trials by headline, and failed ones by error mode. Derived again by whoever checks the file."""

    trials: Count
    headlines: dict[Headline, Count]
    error_modes: dict[ErrorMode, Count]


Evaluated = Literal["self-reported", "hosted"]
"""Who ran an evaluation: the participant, or the host of a leaderboard, who signs the result."""


class Places(_Part):
    """The viewpoints of a scene's presets, by name, and of its home preset."""

    presets: dict[Line, Line]
    home: Line


class Header(_Part):
    """``tasks_digest``: SHA-256 over the tasks' ids, categories, scopes and wordings; ``wanted``: trials of a complete file.

    ``format``: 2 if the trials have traces; ``evaluated``: who ran the evaluation, as the file states it; ``places``: the
    viewpoints of the presets, by scene.
    """

    kind: Literal["header"] = "header"
    format: Literal[1, 2] = 1
    evaluated: Evaluated = "self-reported"
    canary: Literal["SCOPE-BENCH-CANARY 6b0c2f0e-9d1e-4f6c-8a57-0e2f6a1d7c34"] = CANARY
    card: RunCard
    tasks_digest: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    tasks: Count
    wanted: Count
    totals: Totals
    places: dict[str, Places] = {}


class Times(_Part):
    """Wall seconds."""

    planner_s: Seconds
    perception_s: Seconds
    camera_s: Seconds
    render_s: Seconds
    total_s: Seconds


class JudgeSaid(_Part):
    judge: Line
    prompt: Line
    verdict: Literal["correct", "incorrect", "unparseable", "failed"]
    error_mode: ErrorMode | None = None


class Run(_Part):
    """A run. ``trace``: its trace as JSON lines, compressed with zlib, in base64; ``sees``: whether the planner was shown frames;
    ``true_counts``: the true count for each counting call that was looked up, by the index of the call."""

    trace: Annotated[str, Field(max_length=MAX_TRACE_CHARS)]
    sees: bool = False
    true_counts: dict[str, int | None] = {}


class TrialLine(_Part):
    """One trial. ``answer``: the final text, cut at ``MOST_ANSWER`` characters; ``checks``: passed, failed, or None; ``run``: the
    run, in format 2 unless it never began."""

    kind: Literal["trial"] = "trial"
    task: Annotated[str, Field(min_length=1, max_length=200)]
    category: Category
    epoch: Annotated[int, Field(ge=1)]
    headline: Headline
    scored_by: Literal["checks", "judge"]
    error_mode: ErrorMode | None = None
    checks: dict[str, bool | None]
    outcome: str | None
    answer: Annotated[str, Field(max_length=MOST_ANSWER + len(TRUNCATION_MARK))]
    steps: Count
    tool_calls: dict[str, Count]
    bad_calls: Count
    perception_failures: Count
    collateral: bool
    input_tokens: Count
    output_tokens: Count
    cost_usd: Annotated[float, Field(ge=0, allow_inf_nan=False)] | None
    times: Times
    judged: tuple[JudgeSaid, ...] = ()
    run: Run | None = None


LINE: TypeAdapter[Header | TrialLine] = TypeAdapter(Annotated[Header | TrialLine, Field(discriminator="kind")])


class DigestedTask(Protocol):
    """The task attributes that the digest of a set of tasks covers."""

    @property
    def id(self) -> str: ...
    @property
    def category(self) -> Category: ...
    @property
    def scope(self) -> Any: ...
    @property
    def instruction(self) -> str: ...


def submission_schema() -> dict[str, Any]:
    """Return the published JSON schema for one line of a submission."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "A line of a submission", **LINE.json_schema()}


def tasks_digest(tasks: Iterable[DigestedTask]) -> str:
    """Return a digest of a set of tasks. It does not depend on the order of tasks or on duplicates."""
    rows = sorted({f"{task.id}\t{task.category}\t{task.scope}\t{task.instruction}" for task in tasks})
    return hashlib.sha256("\n".join(rows).encode()).hexdigest()


def totals_of(lines: Sequence[TrialLine]) -> Totals:
    """Count trial lines by headline and by error mode."""
    modes = Counter(line.error_mode for line in lines if line.error_mode is not None)
    return Totals(trials=len(lines), headlines=dict(Counter(line.headline for line in lines)), error_modes=dict(modes))


def submission_lines(
    evaluation: Evaluation, runs: Mapping[str, Run] | None = None, places: Mapping[str, Places] | None = None
) -> tuple[Header, list[TrialLine]]:
    """Return the header and the trials of a submission.

    Args:
        evaluation: The evaluation.
        runs: The published runs by sample name, for format 2. Without them, the submission has format 1.
        places: The viewpoints of the presets, by scene.

    Raises:
        InputError: The evaluation is not finished.
    """
    card = evaluation.card
    if not evaluation.finished or not evaluation.trials:
        raise InputError(
            f"The evaluation has only {len(evaluation.trials)} of {evaluation.wanted} trials. Resume it before submitting it."
        )
    lines = [
        trial_line(trial, (runs or {}).get(trial.sample)) for trial in sorted(evaluation.trials, key=lambda t: (t.task.id, t.epoch))
    ]
    facts = {t.task.id: t.task for t in evaluation.trials}
    public = card.model_copy(
        update={
            "planner": _public_card(card.planner),
            "perception": _public_card(card.perception),
            "sampling": public_settings(card.sampling),
            "host": "",
            "split": split_name(card.split),
        }
    )
    header = Header(
        format=1 if runs is None else 2,
        card=public,
        tasks_digest=tasks_digest(facts.values()),
        tasks=len(facts),
        wanted=evaluation.wanted,
        totals=totals_of(lines),
        places=dict(places or {}),
    )
    return header, lines


def write_submission(submission: tuple[Header, list[TrialLine]], out: Path) -> None:
    """Write a submission to a file.

    Raises:
        OutputError: The file cannot be written.
    """
    header, lines = submission
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        # Format 1 must be identical to the files written by version 0.1.0.
        omitted = {"evaluated", "places", "run"} if header.format == 1 else set[str]()
        out.write_text("".join(row.model_dump_json(exclude=omitted) + "\n" for row in (header, *lines)), "utf-8")
    except OSError as error:
        raise OutputError(f"The submission {out} cannot be written: {error.strerror}.") from error


def remove_secrets(text: str) -> str:
    """Replace everything in ``text`` that looks like a key, a token or a server address."""
    return _ADDRESS.sub("[removed]", _SECRET.sub("[removed]", text))


def secrets_in(content: Any, path: str = "") -> Iterator[str]:
    """Yield the paths of values in JSON data that look like keys, tokens or passwords."""
    if isinstance(content, dict):
        for name, value in content.items():
            value_path = f"{path}.{name}" if path else str(name)
            if _SECRET_NAMES.search(str(name)) and isinstance(value, str) and value:
                yield value_path
            yield from secrets_in(value, value_path)
    elif isinstance(content, list | tuple):
        for value in content:
            yield from secrets_in(value, path)
    elif isinstance(content, str) and _SECRET.search(content):
        yield path


def trial_line(trial: Trial, run: Run | None = None) -> TrialLine:
    """Return the published form of a trial. ``run`` is its published run, for format 2."""
    answer = trial.answer if len(trial.answer) <= MOST_ANSWER else trial.answer[:MOST_ANSWER] + TRUNCATION_MARK
    judgements = tuple(
        JudgeSaid(judge=j.judge, prompt=j.prompt, verdict=j.verdict, error_mode=j.error_mode)
        for j in trial.judgements
        if j.repeat == 0
    )
    times = Times(**{name: max(0.0, getattr(trial.timings, name)) for name in Times.model_fields})
    return TrialLine(
        task=trial.task.id,
        category=trial.task.category,
        checks=_check_results(trial.checks),
        answer=_SECRET.sub("[removed]", answer),
        tool_calls=_public_tool_calls(trial.tool_calls),
        times=times,
        judged=judgements,
        run=run,
        **{name: getattr(trial, name) for name in _UNCHANGED_FIELDS},
    )


def _check_results(checks: Sequence[CheckRecord]) -> dict[str, bool | None]:
    return {check.name: check.passed for check in checks}


def _public_tool_calls(calls: Mapping[str, int]) -> dict[str, int]:
    """Return the number of calls to each tool. Calls to tools that do not exist are counted as "unknown"."""
    counts = {name: number for name, number in calls.items() if name in TOOLS}
    unknown = sum(number for name, number in calls.items() if name not in TOOLS)
    return {**counts, UNKNOWN_TOOL: unknown} if unknown else counts


def _public_card(model: ModelCard) -> ModelCard:
    """Remove secrets and addresses from a model card."""
    provider = "" if "://" in model.provider else model.provider
    return model.model_copy(update={"reported": public_settings(model.reported), "provider": provider})


def public_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Remove values that look like secrets or addresses from settings."""
    return {name: _public_value(value) for name, value in settings.items() if not _is_private(name, value)}


def _public_value(value: Any) -> Any:
    if isinstance(value, Mapping):
        return public_settings(value)
    if isinstance(value, list | tuple):
        return [_public_value(item) for item in value if not _is_private("", item)]
    return value


def _is_private(name: str, value: Any) -> bool:
    """Return whether a value must not be published because the value or its name looks like a secret or an address.

    Nested values are checked separately.
    """
    if "://" in name or _SECRET.search(name):
        return True
    return isinstance(value, str) and ("://" in value or any(secrets_in({name: value})))

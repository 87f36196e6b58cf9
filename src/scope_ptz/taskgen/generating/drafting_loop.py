"""The drafting loop: request drafts, validate and record each one, and repeat until there are enough tasks."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass

from scope_ptz.bench.judging.judge import Complete, NoReplyError
from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.reactions import DATASET
from scope_ptz.taskgen.facts.near_duplicates import KnownTasks
from scope_ptz.taskgen.generating.answer_programs import create_task
from scope_ptz.taskgen.generating.draft_ledger import DraftLedger, LedgerEntry
from scope_ptz.taskgen.generating.draft_places import DraftRejectedError
from scope_ptz.taskgen.generating.draft_prompt import build_messages
from scope_ptz.taskgen.generating.draft_schema import Draft, parse_draft, parse_reply, reply_schema
from scope_ptz.taskgen.generating.operator_runs import OperatorRun

BATCH_SIZE = 8  # drafts per request

ValidateTask = Callable[[Task], Awaitable[str | None]]
"""A function that returns why a task is invalid; None if its reference program passes and adversarial attempts fail."""

Progress = Callable[[str], None]
"""A function that receives a line of text."""


@dataclass(frozen=True)
class GenerationRequest:
    """The settings for generating tasks.

    Attributes:
        scene: The scene for the tasks.
        requested: Number of tasks per category.
        known: Tasks that must not be repeated. The prompt uses some of them as examples.
        runs: Operators' recorded runs.
        seed: Seed for every random choice.
        max_requests: Maximum number of requests to the model, including those that are already in the ledger.
        max_failures: Number of consecutive requests without a usable reply after which generation stops.
    """

    scene: Scene
    requested: dict[Category, int]
    known: Sequence[Task] = ()
    runs: Sequence[OperatorRun] = ()
    seed: int = 1
    max_requests: int = 20
    max_failures: int = 3


async def generate(
    request: GenerationRequest, complete: Complete, validate: ValidateTask, ledger: DraftLedger, progress: Progress
) -> None:
    """Request drafts until every category is complete or the maximum number of requests is reached.

    Tasks and requests already in the ledger count towards these limits.

    Args:
        request: The settings.
        complete: Sends a request to the model and returns its reply.
        validate: Validates a task by running it.
        ledger: The ledger to resume and extend.
        progress: Called with a line of text after every request.

    Raises:
        NoReplyError: The model repeatedly gave no usable reply. Tasks that were already kept remain in the ledger.
    """
    known_tasks = KnownTasks([*request.known, *ledger.kept])
    examples = [task for task in request.known if task.scene == request.scene.file.name] or list(request.known)
    failures = 0
    for batch in range(ledger.batches + 1, request.max_requests + 1):
        missing = ledger.missing(request.requested)
        if not missing:
            return
        requested = _allocate_drafts(missing, BATCH_SIZE)
        rng = random.Random(f"{request.seed}:{batch}")
        prompt = build_messages(request.scene, requested, examples, request.runs, ledger.last_reasons(), rng)
        try:
            rows = parse_reply((await complete(prompt, reply_schema())).text)
        except (ValueError, NoReplyError) as error:
            ledger.add(LedgerEntry(batch=batch, fate="no reply", reason=str(error)[:300]))
            progress(f"request {batch}: {error}")
            failures += 1
            if failures == request.max_failures:
                raise NoReplyError(
                    f"{failures} consecutive requests returned no drafts. Check the model and its server. The last error: {error}"
                ) from error
            continue
        failures = 0
        for row in rows:
            entry = await _ledger_entry(row, request, known_tasks, ledger, validate, batch)
            ledger.add(entry)
            if entry.fate == "kept" and entry.task is not None:
                known_tasks.add(entry.task)
        if not rows:
            ledger.add(LedgerEntry(batch=batch, fate="no reply", reason="an empty list"))
        counts_by_fate = Counter(entry.fate for entry in ledger.entries if entry.batch == batch)
        progress(f"request {batch}: " + ", ".join(f"{number} {fate}" for fate, number in counts_by_fate.items()))


async def _ledger_entry(
    row: object, request: GenerationRequest, known_tasks: KnownTasks, ledger: DraftLedger, validate: ValidateTask, batch: int
) -> LedgerEntry:
    """Validate one draft, and return its entry for the ledger."""
    draft = parse_draft(row)
    if not isinstance(draft, Draft):
        return LedgerEntry(batch=batch, fate="dropped", reason=draft, draft=_shorten(row))
    if not ledger.missing(request.requested).get(draft.category):
        reason = f"no more tasks of the category {draft.category} are needed"
        return LedgerEntry(batch=batch, fate="dropped", reason=reason, draft=_shorten(row))
    return await validate_draft(draft, row, request.scene, known_tasks, ledger, validate, batch)


async def validate_draft(
    draft: Draft, row: object, scene: Scene, known_tasks: KnownTasks, ledger: DraftLedger, validate: ValidateTask, batch: int
) -> LedgerEntry:
    """Create a task from a draft, validate it, and return the entry for the ledger.

    Args:
        draft: The draft.
        row: The draft as it was written.
        scene: The task's scene.
        known_tasks: Tasks that must not be repeated.
        ledger: The ledger, which numbers the tasks.
        validate: Validates a task by running it.
        batch: Number of the request.
    """
    name = f"{DATASET}-{scene.name}-generated-{draft.category.replace('_', '-')}-{len(ledger.kept) + 1:03d}"
    try:
        task = create_task(draft, scene, name, DATASET)
    except DraftRejectedError as rejected:
        return LedgerEntry(batch=batch, fate="dropped", reason=str(rejected), draft=_shorten(row))
    if (similar_task := known_tasks.most_similar(task)) is not None:
        reason = f"{similar_task.similarity:.0%} similar to {similar_task.task}"
        return LedgerEntry(batch=batch, fate="near-duplicate", reason=reason, draft=_shorten(row))
    if (fault := await validate(task)) is not None:
        return LedgerEntry(batch=batch, fate="dropped", reason=f"validation failed: {fault}", draft=_shorten(row))
    return LedgerEntry(batch=batch, fate="kept", draft=_shorten(row), task=task)


def _shorten(row: object) -> object:
    """Return a draft for the ledger. If it is large or is not an object, it is replaced with the beginning of its text."""
    return row if isinstance(row, dict) and len(str(row)) < 4000 else str(row)[:300]


def _allocate_drafts(missing: dict[Category, int], size: int) -> dict[Category, int]:
    """Return the number of drafts per category for one request: up to ``size`` in total, taken from the categories in turn."""
    requested: Counter[Category] = Counter()
    while sum(requested.values()) < min(size, sum(missing.values())):
        for category, number in missing.items():
            if requested[category] < number and sum(requested.values()) < size:
                requested[category] += 1
    return dict(requested)

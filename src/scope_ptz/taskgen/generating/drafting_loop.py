"""The drafting loop: request drafts, check and record each of them, and repeat until there are enough tasks."""

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
from scope_ptz.taskgen.generating.answer_programs import task_of
from scope_ptz.taskgen.generating.draft_ledger import DraftLedger, LedgerEntry
from scope_ptz.taskgen.generating.draft_places import DraftRejectedError
from scope_ptz.taskgen.generating.draft_prompt import messages
from scope_ptz.taskgen.generating.draft_schema import Draft, read_draft, read_reply, reply_schema
from scope_ptz.taskgen.generating.operator_runs import OperatorRun

BATCH = 8  # drafts per request

Prove = Callable[[Task], Awaitable[str | None]]
"""Returns why a task is not sound, or None when its reference program passes and adversarial attempts fail."""

Progress = Callable[[str], None]


@dataclass(frozen=True)
class GenerationRequest:
    """What to generate.

    Attributes:
        scene: The scene of the tasks.
        requested: Number of tasks per category.
        known: Tasks that must not be repeated. They also serve as examples.
        runs: Recorded runs of operators.
        seed: Seed for every random choice.
        most_requests: Largest number of requests to the model, earlier ones in the ledger included.
        failures: Number of consecutive requests without a usable reply after which generation stops.
    """

    scene: Scene
    requested: dict[Category, int]
    known: Sequence[Task] = ()
    runs: Sequence[OperatorRun] = ()
    seed: int = 1
    most_requests: int = 20
    failures: int = 3


async def generate(request: GenerationRequest, complete: Complete, prove: Prove, ledger: DraftLedger, progress: Progress) -> None:
    """Request drafts until every category has its number or the requests are used up. Earlier entries of the ledger count.

    Args:
        request: What to generate.
        complete: Sends a request to the model.
        prove: Checks a task by running it.
        ledger: The record to resume and extend.
        progress: Receives a line of text after every request.

    Raises:
        NoReplyError: The model repeatedly gave no usable reply. Tasks that were kept before remain in the ledger.
    """
    known = KnownTasks([*request.known, *ledger.kept])
    examples = [task for task in request.known if task.scene == request.scene.file.name] or list(request.known)
    without = 0
    for batch in range(ledger.batches + 1, request.most_requests + 1):
        missing = ledger.missing(request.requested)
        if not missing:
            return
        requested = _share(missing, BATCH)
        rng = random.Random(f"{request.seed}:{batch}")
        asked = messages(request.scene, requested, examples, request.runs, ledger.last_reasons(), rng)
        try:
            rows = read_reply((await complete(asked, reply_schema())).text)
        except (ValueError, NoReplyError) as error:
            ledger.add(LedgerEntry(batch=batch, fate="no reply", reason=str(error)[:300]))
            progress(f"request {batch}: {error}")
            without += 1
            if without == request.failures:
                raise NoReplyError(f"{without} requests in a row brought no drafts; the last: {error}") from error
            continue
        without = 0
        for row in rows:
            entry = await _checked(row, request, known, ledger, prove, batch)
            ledger.add(entry)
            if entry.fate == "kept" and entry.task is not None:
                known.add(entry.task)
        if not rows:
            ledger.add(LedgerEntry(batch=batch, fate="no reply", reason="an empty list"))
        fates = Counter(entry.fate for entry in ledger.entries if entry.batch == batch)
        progress(f"request {batch}: " + ", ".join(f"{number} {fate}" for fate, number in fates.items()))


async def _checked(
    row: object, request: GenerationRequest, known: KnownTasks, ledger: DraftLedger, prove: Prove, batch: int
) -> LedgerEntry:
    """Check one draft."""
    draft = read_draft(row)
    if not isinstance(draft, Draft):
        return LedgerEntry(batch=batch, fate="dropped", reason=draft, draft=_brief(row))
    number = len(ledger.kept) + 1
    category = draft.category.replace("_", "-")
    name = f"{DATASET}-{request.scene.name}-generated-{category}-{number:03d}"
    if not ledger.missing(request.requested).get(draft.category):
        reason = f"no more tasks of the category {draft.category} are needed"
        return LedgerEntry(batch=batch, fate="dropped", reason=reason, draft=_brief(row))
    try:
        task = task_of(draft, request.scene, name, DATASET)
    except DraftRejectedError as rejected:
        return LedgerEntry(batch=batch, fate="dropped", reason=str(rejected), draft=_brief(row))
    if (near := known.nearest(task)) is not None:
        reason = f"{near.similarity:.0%} similar to {near.task}"
        return LedgerEntry(batch=batch, fate="near-duplicate", reason=reason, draft=_brief(row))
    if (unsound := await prove(task)) is not None:
        return LedgerEntry(batch=batch, fate="dropped", reason=f"validation failed: {unsound}", draft=_brief(row))
    return LedgerEntry(batch=batch, fate="kept", draft=_brief(row), task=task)


def _brief(row: object) -> object:
    """Return a draft for the record. A large draft, or one that is not an object, is cut to the beginning of its text."""
    return row if isinstance(row, dict) and len(str(row)) < 4000 else str(row)[:300]


def _share(missing: dict[Category, int], most: int) -> dict[Category, int]:
    """Return the numbers per category for one request, filled alternately."""
    requested: Counter[Category] = Counter()
    while sum(requested.values()) < min(most, sum(missing.values())):
        for category, number in missing.items():
            if requested[category] < number and sum(requested.values()) < most:
                requested[category] += 1
    return dict(requested)

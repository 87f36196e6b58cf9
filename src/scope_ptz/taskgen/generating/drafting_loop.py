"""Asking for drafts until enough are kept: a request, its drafts checked one by one, each fate recorded, then the next."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass

from scope_ptz.bench.judging.judge import Complete, NoReplyError
from scope_ptz.bench.tasks.task import Category, Task
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.reactions import DATASET
from scope_ptz.taskgen.facts.near_duplicates import Known
from scope_ptz.taskgen.generating.answer_programs import task_of
from scope_ptz.taskgen.generating.draft_ledger import Entry, Ledger
from scope_ptz.taskgen.generating.draft_places import Refused
from scope_ptz.taskgen.generating.draft_prompt import messages
from scope_ptz.taskgen.generating.draft_schema import Draft, read_draft, read_reply, reply_schema
from scope_ptz.taskgen.generating.operator_runs import OperatorRun

BATCH = 8
"""Drafts that are asked for at once."""

Prove = Callable[[Task], Awaitable[str | None]]
"""Why a task is not sound: its reference fails, or a cheat passes; None when all is as it should be."""
Say = Callable[[str], None]


@dataclass(frozen=True)
class Order:
    """What is to be made. ``known``: tasks that must not be repeated, which are also the examples.

    It stops after ``most_requests``, or after so many ``failures`` in a row: requests without a usable reply.
    """

    scene: Scene
    wanted: dict[Category, int]
    known: Sequence[Task] = ()
    runs: Sequence[OperatorRun] = ()
    seed: int = 1
    most_requests: int = 20
    failures: int = 3


async def generate(order: Order, complete: Complete, prove: Prove, ledger: Ledger, say: Say) -> None:
    """Ask until every category has its number or the requests are used up. What was done before is taken as done.

    Raises ``NoReplyError`` when the server gives none any more; what was kept until then stays.
    """
    known = Known([*order.known, *ledger.kept])
    examples = [task for task in order.known if task.scene == order.scene.file.name] or list(order.known)
    without = 0
    for batch in range(ledger.batches + 1, order.most_requests + 1):
        missing = ledger.missing(order.wanted)
        if not missing:
            return
        wanted = _share(missing, BATCH)
        rng = random.Random(f"{order.seed}:{batch}")
        asked = messages(order.scene, wanted, examples, order.runs, ledger.last_reasons(), rng)
        try:
            rows = read_reply((await complete(asked, reply_schema())).text)
        except (ValueError, NoReplyError) as error:
            ledger.add(Entry(batch=batch, fate="no reply", reason=str(error)[:300]))
            say(f"request {batch}: {error}")
            without += 1
            if without == order.failures:
                raise NoReplyError(f"{without} requests in a row brought no drafts; the last: {error}") from error
            continue
        without = 0
        for row in rows:
            entry = await _judged(row, order, known, ledger, prove, batch)
            ledger.add(entry)
            if entry.fate == "kept" and entry.task is not None:
                known.add(entry.task)
        if not rows:
            ledger.add(Entry(batch=batch, fate="no reply", reason="an empty list"))
        fates = Counter(entry.fate for entry in ledger.entries if entry.batch == batch)
        say(f"request {batch}: " + ", ".join(f"{number} {fate}" for fate, number in fates.items()))


async def _judged(row: object, order: Order, known: Known, ledger: Ledger, prove: Prove, batch: int) -> Entry:
    """What becomes of one draft."""
    draft = read_draft(row)
    if not isinstance(draft, Draft):
        return Entry(batch=batch, fate="dropped", reason=draft, draft=_brief(row))
    number = len(ledger.kept) + 1
    category = draft.category.replace("_", "-")
    name = f"{DATASET}-{order.scene.name}-generated-{category}-{number:03d}"
    if not ledger.missing(order.wanted).get(draft.category):
        reason = f"no more tasks of the category {draft.category} are wanted"
        return Entry(batch=batch, fate="dropped", reason=reason, draft=_brief(row))
    try:
        task = task_of(draft, order.scene, name, DATASET)
    except Refused as refused:
        return Entry(batch=batch, fate="dropped", reason=str(refused), draft=_brief(row))
    if (near := known.nearest(task)) is not None:
        reason = f"{near.share:.0%} like {near.task}"
        return Entry(batch=batch, fate="near-duplicate", reason=reason, draft=_brief(row))
    if (unsound := await prove(task)) is not None:
        return Entry(batch=batch, fate="dropped", reason=f"not proved: {unsound}", draft=_brief(row))
    return Entry(batch=batch, fate="kept", draft=_brief(row), task=task)


def _brief(row: object) -> object:
    """A draft for the record; what is no small object is kept as the beginning of its text."""
    return row if isinstance(row, dict) and len(str(row)) < 4000 else str(row)[:300]


def _share(missing: dict[Category, int], most: int) -> dict[Category, int]:
    """The numbers for one request: categories in turn."""
    wanted: Counter[Category] = Counter()
    while sum(wanted.values()) < min(most, sum(missing.values())):
        for category, number in missing.items():
            if wanted[category] < number and sum(wanted.values()) < most:
                wanted[category] += 1
    return dict(wanted)

"""Read a file of drafts that were created from operators' runs, and validate the drafts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.errors import InputError
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.facts.near_duplicates import KnownTasks
from scope_ptz.taskgen.generating.draft_ledger import DraftLedger, LedgerEntry
from scope_ptz.taskgen.generating.draft_schema import parse_draft
from scope_ptz.taskgen.generating.drafting_loop import ValidateTask, validate_draft

ValidatorOf = Callable[[Scene], ValidateTask]
"""A function that returns the task validator for a scene."""


class RunDraft(BaseModel):
    """A line in a file of drafts from runs. Either ``draft`` or ``reason`` is set.

    Attributes:
        run: Name of the run folder.
        scene: The scene; empty if the run had no simulated camera.
        instruction: The operator's instruction.
        note: The operators' comments.
        draft: The draft.
        reason: Why the run cannot be converted to a draft.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    run: str = Field(min_length=1, max_length=200)
    scene: str = Field(default="", max_length=200)
    instruction: str = ""
    note: str = ""
    draft: Any = None
    reason: str = ""


def read_run_drafts(path: Path) -> list[RunDraft]:
    """Read a file of drafts from runs.

    Raises:
        InputError: The file cannot be read, or a line is not a draft.
    """
    try:
        lines = path.read_text("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a text file"
        raise InputError(f"The drafts file {path} cannot be read: {reason}.") from error
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            if line.strip():
                rows.append(RunDraft.model_validate_json(line))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            raise InputError(
                f"{path}, line {number}: {'.'.join(map(str, first['loc'])) or 'row'}: {first['msg']}. "
                "Write the file with `scope runs export --format drafts`."
            ) from error
    return rows


async def validate_run_drafts(
    rows: Sequence[RunDraft],
    open_scene: Callable[[str], Scene | None],
    validator_of: ValidatorOf,
    known_tasks: KnownTasks,
    ledger: DraftLedger,
) -> None:
    """Validate drafts from runs, and record each one in the ledger. Drafts that are already in the ledger are skipped.

    Args:
        rows: The lines of the file.
        open_scene: A function that opens a scene by its name. It returns None if the scene is not installed or has no ground truth.
        validator_of: A function that returns the task validator for a scene.
        known_tasks: Tasks that must not be repeated. Accepted tasks are added.
        ledger: The ledger to extend.
    """
    recorded = [entry.draft for entry in ledger.entries]
    scenes: dict[str, tuple[Scene, ValidateTask] | None] = {}
    for row in rows:
        original = row.draft if row.draft is not None else row.instruction
        if original in recorded:
            continue
        entry = LedgerEntry(batch=1, fate="dropped", reason=row.reason or "the line has no draft", draft=original)
        if row.draft is not None:
            if row.scene not in scenes:
                opened = open_scene(row.scene)
                scenes[row.scene] = None if opened is None else (opened, validator_of(opened))
            scene_and_validator, draft = scenes[row.scene], parse_draft(row.draft)
            if isinstance(draft, str):
                entry = entry.model_copy(update={"reason": draft})
            elif scene_and_validator is None:
                entry = entry.model_copy(update={"reason": f"there is no scene '{row.scene[:60]}' with ground truth"})
            else:
                scene, validate = scene_and_validator
                entry = await validate_draft(draft, row.draft, scene, known_tasks, ledger, validate, 1)
        ledger.add(entry)
        recorded.append(original)
        if entry.fate == "kept" and entry.task is not None:
            known_tasks.add(entry.task)

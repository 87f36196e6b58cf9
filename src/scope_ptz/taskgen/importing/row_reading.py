"""Convert a row of an imported CSV file to a task, or report why the task cannot be run."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from scope_ptz.bench.tasks.findings import FindingKind, RowFinding
from scope_ptz.bench.tasks.imported import ImportedTask, Policy
from scope_ptz.bench.tasks.task import Category, RequiredCall, Scope
from scope_ptz.bench.tasks.task_facts import TaskFacts
from scope_ptz.bench.tasks.task_wording import call_in_words
from scope_ptz.taskgen.importing.call_mapping import MappedCalls, expected_calls
from scope_ptz.taskgen.importing.contradictions import field_contradictions
from scope_ptz.taskgen.importing.csv_table import Row
from scope_ptz.taskgen.importing.paper_names import category_of, compares_arguments, normalise, order_of, policy_of, scope_of
from scope_ptz.taskgen.importing.scene_names import SceneNames
from scope_ptz.tools.registry import TOOLS

MOVING_TOOLS = TOOLS.moving
_DIFFICULTIES: dict[str, Literal["easy", "medium", "hard"]] = {
    "easy": "easy", "simple": "easy", "low": "easy", "1": "easy", "medium": "medium", "moderate": "medium", "mid": "medium",
    "normal": "medium", "2": "medium", "hard": "hard", "difficult": "hard", "high": "hard", "3": "hard",
}  # fmt: skip
_MAX_QUESTION_CHARS = 4000  # longer questions are truncated
AddFinding = Callable[[FindingKind, str], None]
"""A function that adds a finding, given its type and its detail."""


@dataclass(frozen=True)
class ParsedRow:
    """A row with its cells converted to SCOPE's types and names.

    ``scene`` and ``preset`` are SCOPE's names, or None if there is no match. ``place`` contains the location and the preset as
    written in the file. ``view`` is a key for the view that the file refers to. Two presets in the file have different keys even if
    they are mapped to the same preset in SCOPE.
    """

    row: Row
    question: str
    answer: str
    category: Category | None
    scope: Scope
    scene: str | None
    preset: str | None
    place: tuple[str, str]
    view: tuple[str, str]
    calls: tuple[RequiredCall, ...]
    policy: Policy
    order: Literal["ordered", "any"]
    difficulty: Literal["easy", "medium", "hard"]
    findings: tuple[RowFinding, ...]

    @property
    def line(self) -> int:
        """The number of the line on which the row begins."""
        return self.row.line

    @property
    def sweeps(self) -> bool:
        """Whether the question is about the whole scene."""
        return self.scope == "full"

    @property
    def moves(self) -> bool:
        """Whether one of the expected calls moves the camera."""
        return any(call.tool in MOVING_TOOLS for call in self.calls)

    def task(self, dataset: str, name: str, scene_names: SceneNames, findings: tuple[RowFinding, ...]) -> ImportedTask | None:
        """Create a task from the row. Return None if the row cannot be run.

        Args:
            dataset: Name of the dataset.
            name: Id of the task.
            scene_names: The available scenes.
            findings: All findings about the row.
        """
        if self.scene is None or self.preset is None or self.category is None or any(f.blocks for f in findings):
            return None
        notes = self.row.cells.get("evaluation_notes", "")
        facts = TaskFacts(
            id=name,
            dataset=dataset,
            stratum="imported",
            scene=self.scene,
            viewpoint=scene_names.viewpoint(self.scene, self.preset),
            preset=self.preset,
            instruction=self.question[:_MAX_QUESTION_CHARS],
            category=self.category,
            scope=self.scope,
            difficulty=self.difficulty,
            expected=self.answer or "no answer is given; the expected calls decide",
            demands=tuple(_requirements(self.calls, self.policy, self.order, notes)),
        )
        return ImportedTask(
            facts=facts,
            line=self.line,
            raw=self.row.cells,
            calls=self.calls,
            policy=self.policy,
            order=self.order,
            start_s=scene_names.scenes[self.scene].start_s,
            findings=findings,
        )


def parse_row(row: Row, scene_names: SceneNames) -> ParsedRow:
    """Convert the cells of a row, and add a finding for everything that is missing, unknown or unusual."""
    cells, findings = row.cells, list[RowFinding]()

    def add_finding(kind: FindingKind, detail: str) -> None:
        findings.append(RowFinding(kind=kind, detail=detail[:300]))

    question, answer = cells["question"], cells["expected_answer"]
    place = cells.get("file_location", ""), cells.get("preset_start", "")
    if not question:
        add_finding("empty-question", "")
    category = _parse_category(cells, add_finding)
    scene, preset = _find_place(cells, scene_names, add_finding)
    policy, order, compare = _parse_modes(cells, add_finding)
    mapped_calls = expected_calls(
        cells.get("expected_tool_order_json", cells.get("expected_tool_order", "")),
        cells.get("expected_tool_args_json", cells.get("expected_tool_args", "")),
        compare=compare,
        preset_of=lambda name: scene_names.preset(scene, name) if scene is not None and name.strip() else name,
    )
    findings += mapped_calls.findings
    if not answer and not mapped_calls.calls:
        add_finding("nothing-expected", "")
    scope = _parse_scope(cells, mapped_calls, add_finding)
    for detail in field_contradictions(cells, mapped_calls.calls, scene_names.scenes[scene].presets if scene is not None else ()):
        add_finding("fields-disagree", detail)
    if row.extra or row.missing:
        add_finding("ragged-row", f"{len(row.extra)} cells too many" if row.extra else f"{row.missing} cells too few")
    return ParsedRow(
        row=row,
        question=question,
        answer=answer,
        category=category,
        scope=scope,
        scene=scene,
        preset=preset,
        place=place,
        view=scene_names.source_view(*place),
        calls=tuple(mapped_calls.calls),
        policy=policy,
        order=order,
        difficulty=_parse_difficulty(cells.get("difficulty", ""), add_finding),
        findings=tuple(findings),
    )


def unique_ids(rows: list[Row], dataset: str) -> list[str]:
    """Return a unique task id for every row. The id contains the row's own id or, if it has none, its line number."""
    base_ids = [f"{dataset}-{_slug(row.cells.get('question_id', '')) or f'line-{row.line}'}" for row in rows]
    uses, ids = Counter[str](), list[str]()
    for name in base_ids:
        uses[name] += 1
        unique = name if uses[name] == 1 else f"{name}-x{uses[name]}"
        while unique in ids:
            unique += "x"
        ids.append(unique)
    return ids


def _slug(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:80]


def _parse_category(cells: Mapping[str, str], add_finding: AddFinding) -> Category | None:
    columns = ("eval_category", "category", "question_type")
    filled = {column: cells[column] for column in columns if cells.get(column)}
    match = next(((name, category) for name, text in filled.items() if (category := category_of(text)) is not None), None)
    if match is None:
        add_finding("unknown-category", next(iter(filled.values()), ""))
        return None
    column, category = match
    first = next(iter(filled))
    if column != first:
        add_finding("unknown-value", f"{first}: {filled[first]}; read as {category}, based on {column}: {filled[column]}")
    return category


def _find_place(cells: Mapping[str, str], scene_names: SceneNames, add_finding: AddFinding) -> tuple[str | None, str | None]:
    location, start = cells.get("file_location", ""), cells.get("preset_start", "")
    scene = scene_names.scene(location)
    if scene is None:
        add_finding("missing-scene", location)
        return None, None
    preset = scene_names.preset(scene, start)
    if preset is None:
        add_finding("missing-preset", f"{scene}: {start}")
    return scene, preset


def _parse_modes(cells: Mapping[str, str], add_finding: AddFinding) -> tuple[Policy, Literal["ordered", "any"], bool]:
    policy_cell, order_cell = cells.get("required_tools_policy", ""), cells.get("multi_step_mode", "")
    check_cell = cells.get("args_check", "")
    policy, order, compare = policy_of(policy_cell), order_of(order_cell), compares_arguments(check_cell)
    for column, cell, parsed in (
        ("required_tools_policy", policy_cell, policy),
        ("multi_step_mode", order_cell, order),
        ("args_check", check_cell, compare),
    ):
        if parsed is None:
            add_finding("unknown-value", f"{column}: {cell}")
    return policy or "all", order or "any", compare if compare is not None else True


def _parse_scope(cells: Mapping[str, str], mapped_calls: MappedCalls, add_finding: AddFinding) -> Scope:
    """Return the scope in the cell ``answer_view``.

    If it has none, return "full" if an expected call uses the full view, otherwise "current".
    """
    cell = cells.get("answer_view", "")
    scope = scope_of(cell)
    if scope is not None:
        return scope
    if cell and normalise(cell) not in ("none", "na", "n_a", "null", "any", "either"):
        add_finding("unknown-value", f"answer_view: {cell}")
    views = {call.arguments["view"].equals for call in mapped_calls.calls if "view" in call.arguments}
    return "full" if "full" in views else "current"


def _parse_difficulty(cell: str, add_finding: AddFinding) -> Literal["easy", "medium", "hard"]:
    difficulty = _DIFFICULTIES.get(normalise(cell))
    if difficulty is None and cell:
        add_finding("unknown-value", f"difficulty: {cell}")
    return difficulty or "medium"


_POLICY_WORDS: dict[Policy, str] = {
    "all": "All of these calls are expected",
    "exact": "These calls and no other tools are expected",
    "any": "One of these calls is expected",
    "none": "Calls that the author of the task had in mind, which need not be made",
}


def _requirements(calls: Sequence[RequiredCall], policy: Policy, order: str, notes: str) -> Iterator[str]:
    if calls:
        order_note = ", in this order" if order == "ordered" and policy in ("all", "exact") and len(calls) > 1 else ""
        yield f"{_POLICY_WORDS[policy]}{order_note}: {'; '.join(call_in_words(call) for call in calls)}."
    if notes:
        yield f"Notes of the author of the task: {notes}"

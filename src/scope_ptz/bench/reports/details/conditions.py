"""The section on the conditions of the runs: models, tasks and run cards."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from scope_ptz.bench.reports.details.accuracy import KIND_TITLES
from scope_ptz.bench.reports.details.difficulty import CLASSES
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun, is_mixture, runs_of_main_set
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, ReportTable
from scope_ptz.registry import Model


def conditions_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on the models, the tasks, and the conditions of each run."""
    columns = (
        Column("run", "Run"),
        Column("kind", "Kind"),
        Column("dataset", "Dataset"),
        Column("split", "Split"),
        Column("trials", "Trials", "count"),
        Column("wanted", "Planned trials", "count"),
        Column("epochs", "Repeats", "count"),
        Column("agent", "Agent"),
        Column("variant", "Variant"),
        Column("max_steps", "Step limit", "count"),
        Column("seed", "Seed"),
        Column("sampling", "Sampling", "prose"),
        Column("prompt", "Prompt"),
        Column("planner_reported", "Reported by the planner's server", "prose"),
        Column("eyes_reported", "Reported by the perception server", "prose"),
        Column("concurrency", "Concurrency", "count"),
        Column("timing", "Timing"),
        Column("package", "scope-ptz"),
        Column("engine", "Engine"),
        Column("tasks_digest", "Digest of the tasks"),
        Column("started", "Started"),
        Column("host", "Host"),
    )
    text = ("The models as the registry describes them, the tasks, and the conditions of each run from its run card.",)
    table = ReportTable("runs", "Runs and their conditions", columns, tuple(_card_row(run) for run in runs))
    return Section("runs", "Conditions", text, (), (_model_table(runs), _task_table(runs), table), frozenset({"runs"}))


def _model_table(runs: Sequence[ReportRun]) -> ReportTable:
    columns = (
        Column("model", "Model"), Column("role", "Role"), Column("title", "In the registry"),
        Column("size_b", "Parameters (10^9)", "number"), Column("active_b", "Active (10^9)", "number"),
        Column("precision", "Precision"), Column("kind", "Kind"), Column("memory_gb", "Memory (GB, computed)", "gb"),
        Column("pairs", "Runs", "count"),
    )  # fmt: skip
    rows: list[tuple[CellValue, ...]] = []
    for role in ("planner", "perception"):
        by_name: dict[str, list[ReportRun]] = {}
        for run in runs:
            if not getattr(run.evaluation.card, role).deterministic and run.kind != "person":
                by_name.setdefault(getattr(run, f"{role}_name"), []).append(run)
        rows += [(name, role, *_model_cells(getattr(own[0], role)), len(own)) for name, own in sorted(by_name.items())]
    notes = (
        "A mixture of experts has fewer active than total parameters. Models that are not in the registry are listed without "
        "details.",
    )
    return ReportTable("models", "Models of these runs", columns, tuple(rows), notes)


def _model_cells(model: Model | None) -> tuple[CellValue, ...]:
    """Return the table cells for a model: title, parameters, active parameters, precision, kind and memory."""
    if model is None:
        return (None,) * 6
    kind = "mixture of experts" if is_mixture(model) else "dense"
    return model.title, float(model.size_b), float(model.active_b), model.precision, kind, model.memory_for()


def _task_table(runs: Sequence[ReportRun]) -> ReportTable:
    """Return a table with the number of tasks in each category that the runs of the main task set cover."""
    facts = {t.task.id: t.task for run in runs_of_main_set(runs) for t in run.main_trials}
    columns = (
        Column("category", "Category"), Column("tasks", "Tasks", "count"), Column("current", "Current view", "count"),
        Column("full", "Full scene", "count"), *(Column(name, name.capitalize(), "count") for name in CLASSES),
    )  # fmt: skip
    rows: list[tuple[CellValue, ...]] = []
    for category, title in (*CATEGORY_TITLES.items(), ("", "All")):
        own = [task for task in facts.values() if category in (task.category, "")]
        if own:
            by_scope, by_class = Counter(t.scope for t in own), Counter(t.difficulty for t in own)
            rows.append((title, len(own), by_scope["current"], by_scope["full"], *(by_class[name] for name in CLASSES)))
    return ReportTable("tasks", "Tasks by category, scope and difficulty", columns, tuple(rows))


def _card_row(run: ReportRun) -> tuple[CellValue, ...]:
    card = run.evaluation.card
    sampling = ", ".join(f"{key} {value}" for key, value in _flatten(card.sampling))
    return (
        run.label,
        KIND_TITLES[run.kind],
        card.dataset,
        run.task_set[1],
        len(run.evaluation.trials),
        run.evaluation.wanted,
        card.epochs,
        card.agent_label,
        card.variant or "as it is",
        card.max_steps,
        None if card.seed is None else str(card.seed),
        sampling or None,
        card.prompt_digest[:12] or None,
        _reported_text(card.planner.reported),
        _reported_text(card.perception.reported),
        card.concurrency,
        "contended" if card.contended else "alone",
        card.package_version,
        card.engine_version,
        card.dataset_digest[:12] or None,
        card.started,
        card.host or None,
    )


def _flatten(settings: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the values of nested settings with their full names, such as ``planner.temperature``."""
    for key, value in sorted(settings.items()):
        if isinstance(value, Mapping):
            yield from _flatten(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _reported_text(reported: Mapping[str, str]) -> str | None:
    return ", ".join(f"{key} {value}" for key, value in sorted(reported.items())) or None

"""The section with the paper's published results."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from pydantic import BaseModel, ConfigDict

from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable


class _Row(BaseModel):
    """A row of one of the paper's tables. ``line`` is its line in the paper's LaTeX source."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    line: int


class PaperSource(BaseModel):
    """The title and DOI of the paper, and the judge that it used."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    title: str
    doi: str
    judge: str


class PaperCategory(_Row):
    """The number of tasks in a category."""

    category: str
    tasks: int


class PaperMode(_Row):
    """An error mode and its meaning."""

    mode: str
    description: str


class PaperModel(_Row):
    """A model that the paper evaluates. Sizes are in billions of parameters."""

    title: str
    name: str
    role: str
    size_b: float
    active_b: float
    precision: str


class PaperAccuracy(_Row):
    """The accuracy of a pair in percent.

    ``planner`` and ``eyes`` (the perception model) are registry names. The other fields are the categories and their average.
    """

    planner: str
    eyes: str
    average: float
    comparative: float
    counting: float
    descriptor: float
    location: float
    multi_step_command: float
    multi_step_reasoning: float
    ocr: float
    single_call: float

    def category(self, name: str) -> float:
        """Return the accuracy in a category in percent."""
        return float(getattr(self, name))


class PaperLatency(_Row):
    """The latency and number of tool calls of a model."""

    role: str
    name: str
    median_s: float
    tool_calls: float


class PaperFigure(_Row):
    """A number from the paper that is not part of the other tables."""

    what: str
    value: str


class Paper(BaseModel):
    """All results in the paper."""

    model_config = ConfigDict(frozen=True, extra="forbid")
    paper: PaperSource
    categories: tuple[PaperCategory, ...]
    error_modes: tuple[PaperMode, ...]
    models: tuple[PaperModel, ...]
    accuracy: tuple[PaperAccuracy, ...]
    latency: tuple[PaperLatency, ...]
    figures: tuple[PaperFigure, ...]

    def micro_average_percent(self, row: PaperAccuracy) -> float:
        """Compute the micro average for a row in percent. The paper states only macro averages."""
        correct = sum(round(row.category(c.category) * c.tasks / 100) for c in self.categories)
        return 100 * correct / sum(c.tasks for c in self.categories)


@cache
def load_paper() -> Paper:
    """Load the paper's results from the package data."""
    import yaml

    text = files("scope_ptz").joinpath("data", "paper.yaml").read_text(encoding="utf-8")
    return Paper.model_validate(yaml.safe_load(text))


def paper_section() -> Section:
    """Return the section with the paper's results."""
    paper = load_paper()
    text = (
        f"All values in this section are copied from the paper ({paper.paper.title}, doi {paper.paper.doi}). None was measured in "
        "these runs. They are a point of reference and are not comparable task by task: the paper's 536 tasks, scenes and servers "
        f"are different, and its verdicts were given by a judge ({paper.paper.judge}), not by checks.",
    )
    tables = (_accuracy(paper), _latency(paper), _figures(paper), _models(paper), _categories(paper), _modes(paper))
    return Section(
        "paper", "The paper's published figures", text, (), tables, frozenset({"paper_models", "paper_categories", "paper_modes"})
    )


def _accuracy(paper: Paper) -> ReportTable:
    columns = [Column("planner", "Planner"), *(Column(n, words, "share") for n, words in CATEGORY_TITLES.items())]
    columns += [Column("average", "Average (macro)", "share"), Column("micro", "Micro, computed from these", "share")]
    columns.append(Column("line", "Line", "count"))
    groups, rows, previous = {}, [], None
    for number, row in enumerate(paper.accuracy):
        if row.eyes != previous:
            groups[number] = previous = row.eyes
        same_perception = [other for other in paper.accuracy if other.eyes == row.eyes]
        names = (*CATEGORY_TITLES, "average")
        cells: list[CellValue] = [
            MarkedCell(
                float(getattr(row, name)) / 100,
                best=getattr(row, name) >= max(getattr(other, name) for other in same_perception),
                best_of_all=getattr(row, name) >= max(getattr(other, name) for other in paper.accuracy),
            )
            for name in names
        ]
        rows.append((row.planner, *cells, paper.micro_average_percent(row) / 100, row.line))
    notes = (
        "Values are in percent. The paper's average is the macro average. The value 36.5 (qwen3-next-80b-a3b with moondream2-4bit, "
        "comparative) is not a possible fraction of 62 tasks.",
    )
    return ReportTable("paper_accuracy", "The paper: accuracy by category", tuple(columns), tuple(rows), notes, groups)


def _latency(paper: Paper) -> ReportTable:
    columns = (
        Column("model", "Model"), Column("role", "Role"), Column("median_s", "Median latency (s)", "seconds"),
        Column("tool_calls", "Tool calls, mean", "number"), Column("line", "Line", "count"),
    )  # fmt: skip
    rows = tuple((row.name, row.role, row.median_s, row.tool_calls, row.line) for row in paper.latency)
    notes = ("Inference latency in the paper's serving setup, partly under contention, as the paper states in its limitations.",)
    return ReportTable("paper_latency", "The paper: latency and tool calls", columns, rows, notes)


def _figures(paper: Paper) -> ReportTable:
    columns = (Column("what", "Quantity"), Column("value", "Value"), Column("line", "Line", "count"))
    rows = tuple((figure.what, figure.value, figure.line) for figure in paper.figures)
    return ReportTable("paper_figures", "The paper: other results", columns, rows)


def _models(paper: Paper) -> ReportTable:
    columns = (
        Column("title", "Model"), Column("name", "Name in the registry"), Column("role", "Role"),
        Column("size_b", "Parameters (10^9)", "number"), Column("active_b", "Active (10^9)", "number"),
        Column("precision", "Precision"), Column("line", "Line", "count"),
    )  # fmt: skip
    rows = tuple((m.title, m.name, m.role, m.size_b, m.active_b, m.precision, m.line) for m in paper.models)
    return ReportTable("paper_models", "The paper: models", columns, rows)


def _categories(paper: Paper) -> ReportTable:
    columns = (Column("category", "Category"), Column("tasks", "Tasks", "count"), Column("line", "Line", "count"))
    rows = tuple((CATEGORY_TITLES[c.category], c.tasks, c.line) for c in paper.categories)
    return ReportTable("paper_categories", "The paper: tasks by category", columns, rows)


def _modes(paper: Paper) -> ReportTable:
    columns = (Column("mode", "Error mode"), Column("description", "Meaning"), Column("line", "Line", "count"))
    return ReportTable(
        "paper_modes", "The paper: error modes", columns, tuple((m.mode, m.description, m.line) for m in paper.error_modes)
    )

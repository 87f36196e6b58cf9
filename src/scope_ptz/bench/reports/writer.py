"""Write a report: an HTML page, Markdown, CSV files, and a page for each failed task. Text from models is escaped."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scope_ptz.bench.reports.assemble import EvaluationReport, build_report
from scope_ptz.bench.reports.chart_style import standalone_svg
from scope_ptz.bench.reports.tables import (
    MISSING,
    CellValue,
    Column,
    MarkedCell,
    cell_text,
    cell_value,
    csv_text,
    escape,
    interval_texts,
    markdown_text,
)
from scope_ptz.bench.reports.task_pages import FrameStore, OpenSample, page_files, task_pages
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import OutputError
from scope_ptz.registry import Registry
from scope_ptz.version import __version__

if TYPE_CHECKING:
    from jinja2 import Environment

GENERATOR = "scope bench report"
"""Content of the page's ``generator`` tag, by which an earlier report is recognised."""
_REPORT_FILES = (("tables", "*.csv"), ("tasks", "*.html"), ("frames", "*.jpg"), ("charts", "*.svg"))
"""Folders in a report, and the patterns of the files in them."""


def write_report(
    evaluations: Sequence[Evaluation],
    registry: Registry,
    out: Path,
    *,
    open_sample: OpenSample | None = None,
    tasks: Mapping[str, Task] | None = None,
    progress: Callable[[int, int], None] | None = None,
    pages: bool = True,
) -> EvaluationReport:
    """Write a report: ``index.html``, ``report.md``, ``charts/*.svg``, ``tables/*.csv``, ``tasks/*.html`` and ``frames/*.jpg``.

    Args:
        evaluations: The evaluations.
        registry: The model registry.
        out: The report folder. An earlier report in it is replaced.
        open_sample: Function that opens the stored run of a trial. Without it, the pages show no trajectories.
        tasks: The tasks by id, for the evidence on the pages and the scores of constant answers.
        progress: Called after each page with the number of finished pages and the total number of pages.
        pages: Whether to write pages for failed tasks.

    Returns:
        The report.

    Raises:
        OutputError: The folder cannot be written to, or it is not empty and contains no report.
        InputError: The evaluations contain no trials.
    """
    files = page_files(evaluations) if pages else {}
    report = build_report(evaluations, registry, files, tasks)
    try:
        _remove_earlier_report(out)
        (out / "tables").mkdir(parents=True, exist_ok=True)
        (out / "tasks").mkdir(exist_ok=True)
        page_builders = task_pages(report.runs, files, open_sample, FrameStore(out / "frames", "../frames"), tasks or {})
        environment = _environment()
        template = environment.get_template("task.html.j2")
        for number, build_page in enumerate(page_builders, 1):
            page = build_page()
            (out / page.file).write_text(template.render(page=page, version=__version__), "utf-8")
            if progress is not None:
                progress(number, len(page_builders))
        for table in report.tables:
            (out / "tables" / f"{table.key}.csv").write_text(csv_text(table), "utf-8", newline="")
        (out / "charts").mkdir(exist_ok=True)
        for chart in (chart for section in report.sections for chart in section.charts):
            (out / "charts" / f"{chart.key}.svg").write_text(standalone_svg(chart), "utf-8")
        (out / "report.md").write_text(render_markdown(report), "utf-8")
        (out / "index.html").write_text(render_html(report, environment), "utf-8")
    except OSError as error:
        raise OutputError(f"The report cannot be written to {out}: {error.strerror}.") from error
    return report


def _remove_earlier_report(out: Path) -> None:
    """Remove the files of an earlier report from a folder. Raises ``OutputError`` if the folder contains no report."""
    if out.exists() and not out.is_dir():
        raise OutputError(f"{out} is a file. Choose a folder for the report.")
    if not out.exists() or not any(out.iterdir()):
        return
    page = out / "index.html"
    if not page.is_file() or f'content="{GENERATOR}' not in page.read_text("utf-8", errors="replace")[:2000]:
        raise OutputError(f"{out} is not empty and contains no report. Choose an empty folder or a new name.")
    for folder, pattern in _REPORT_FILES:
        for file in (out / folder).glob(pattern):
            file.unlink()


def render_html(report: EvaluationReport, environment: Environment | None = None) -> str:
    """Render the HTML page, which contains no scripts and loads nothing from the network."""
    template = (environment or _environment()).get_template("index.html.j2")
    return template.render(report=report, version=__version__, generator=GENERATOR)


def render_markdown(report: EvaluationReport) -> str:
    """Render the report as Markdown that embeds the chart files in ``charts/``."""
    parts = ["# SCOPE benchmark report"]
    parts += [f"> **{escape(report.notice)}**"] if report.notice else []
    parts += ["> " + escape(line) for line in (*report.contradictions, *report.problems)]
    for number, section in enumerate(report.sections):
        parts.append(f"## {escape(section.title)}")
        parts += [escape(line) for line in section.text]
        parts += [f"![{escape(chart.title)}](charts/{chart.key}.svg)" for chart in section.charts]
        parts += [markdown_text(table) for table in section.tables]
        if number == 0:
            parts += ["## Summary", *(escape(line) for line in report.summary), *("> " + escape(line) for line in report.warnings)]
    return "\n\n".join(parts) + f"\n\n*Made by scope-ptz {__version__}.*\n"


def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("scope_ptz", "data/report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["cell"] = cell
    environment.filters["drawn"] = Markup  # Used only for charts, whose text is already escaped by the drawing library.
    return environment


def cell(value: CellValue, column: Column) -> dict[str, Any]:
    """Return the parts of a cell for the template: the text, the interval with its limitation, and the marks."""
    plain = cell_value(value)
    marks = value if isinstance(value, MarkedCell) else MarkedCell(None)
    bounds = limits = ""
    if isinstance(plain, IntervalEstimate):
        bounds, limits = interval_texts(plain, column.kind)
        plain = plain.value
    text = cell_text(plain, column.kind)
    return {
        "words": text, "interval": bounds, "limits": limits, "missing": text == MISSING,
        "text": column.is_text, "prose": column.kind == "prose",
        "best": marks.best, "best_of_all": marks.best_of_all, "link": marks.link, "note": marks.note,
    }  # fmt: skip

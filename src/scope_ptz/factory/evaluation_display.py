"""Terminal output of evaluations: notes and the estimate, a live table, and the final scores."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from scope_ptz.bench.agents.channel import ISOLATION_NOTES
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.estimate_text import duration_text, estimate_lines
from scope_ptz.bench.engine.failure_summary import counts_text, server_events
from scope_ptz.bench.engine.run_totals import CATEGORIES, accuracy
from scope_ptz.bench.judging.deciding_judge import other_judges_note
from scope_ptz.bench.judging.judgement_tally import lacks_verdict, needs_judgement
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.factory.evaluation_options import EvaluationPlan, EvaluationProgress

PRINT_EVERY_S = 15.0
"""Seconds between progress lines if the output is not a terminal."""
MAX_RUNNING_SHOWN = 6  # maximum number of runs in progress to name below the table
RULE_BASED_NOTE = (
    "This is the built-in rule-based planner: a baseline and a check of the installation, not the result of a model.\n"
    "To score a model, run: scope bench run --planner-url http://HOST:PORT/v1 (scope models lists models)."
)
GROUND_TRUTH_NOTE = (
    "Perception is the simulator's ground truth, not a model, so the score is not the result of a pair of models.\n"
    "To use a vision model, add --perception NAME --perception-url http://HOST:PORT/v1 (scope models lists models)."
)


class LiveProgress(EvaluationProgress):
    """Prints notes and the estimate, and shows a live table with the results so far.

    Args:
        console: The console to print on.
        notify: Function that prints a note.
    """

    def __init__(self, console: Console, notify: Callable[[str], None]) -> None:
        self._console, self._notify = console, notify
        self._plan: EvaluationPlan | None = None
        self._trials: dict[str, Trial] = {}
        self._running: dict[str, float] = {}
        self._started_s = self._last_printed_s = time.monotonic()
        self._live: Live | None = None

    def note(self, text: str) -> None:
        self._notify(text)

    def _print(self, text: str) -> None:
        self._console.print(text, highlight=False, soft_wrap=True, markup=False)

    def planned(self, plan: EvaluationPlan) -> None:
        lines = estimate_lines(
            plan.estimate,
            planner=plan.planner,
            perception=plan.perception,
            concurrency=plan.concurrency,
            agent=plan.agent,
            isolation=plan.isolation,
            planner_is_free=not plan.uses_planner_server,
        )
        for line in filter(None, (plan.origin, *lines)):
            self._print(line)
        self._plan, self._trials = plan, {trial.sample: trial for trial in plan.finished}
        self._started_s = self._last_printed_s = time.monotonic()
        if self._console.is_terminal:
            self._live = Live(get_renderable=self._render, console=self._console, refresh_per_second=2)
            self._live.start()

    def closed(self) -> None:
        if self._live is not None:
            self._live.stop()
            self._live = None

    def run_began(self, sample: str, entry: Entry) -> None:  # noqa: ARG002 - the watcher's signature
        self._running[sample] = time.monotonic()

    def run_ended(self, sample: str, trial: Trial) -> None:
        self._running.pop(sample, None)
        self._trials[sample] = trial
        now = time.monotonic()
        if self._live is None and now - self._last_printed_s >= PRINT_EVERY_S:
            self._last_printed_s = now
            self._print(self._progress_line())

    def _seconds_left(self) -> float | None:
        newly_finished = len(self._trials) - len(self._plan.finished) if self._plan is not None else 0
        if newly_finished < 1 or self._plan is None:
            return None
        return (time.monotonic() - self._started_s) / newly_finished * (self._plan.runs - len(self._trials))

    def _progress_line(self) -> str:
        seconds_left, trials = self._seconds_left(), self._trials.values()
        correct = sum(t.headline == "correct" for t in trials)
        broken = sum(t.headline == "infrastructure" for t in trials)
        pending = sum(lacks_verdict(t) for t in trials)
        time_note = f", about {duration_text(seconds_left)} left" if seconds_left is not None else ""
        pending_note = f", {pending} not judged yet" if pending else ""
        total = self._plan.runs if self._plan is not None else len(trials)
        return (
            f"{len(trials)} of {total} runs: {correct} correct{pending_note}, {broken} failed because of infrastructure{time_note}"
        )

    def _render(self) -> RenderableType:
        trials = list(self._trials.values())
        title, total = (self._plan.pair, self._plan.runs) if self._plan is not None else ("", len(trials))
        head = Text.assemble((title, "bold"), "  ", self._progress_line())
        bar = ProgressBar(total=total or 1, completed=len(trials), width=60)
        now = time.monotonic()
        longest_running = sorted(self._running.items(), key=lambda item: item[1])[:MAX_RUNNING_SHOWN]
        names = ", ".join(
            f"{name.rpartition('#')[0].partition('-')[2]} {now - started_s:.0f} s" for name, started_s in longest_running
        )
        more = len(self._running) - len(longest_running)
        running = Text(
            f"running  {names or 'nothing yet'}{f' and {more} more' if more > 0 else ''}", style="dim", overflow="ellipsis"
        )
        return Group(head, bar, category_table(trials), running)


def category_table(trials: Iterable[Trial]) -> Table:
    """Return a table of accuracy by category, with macro and micro averages."""
    rows = list(trials)
    table = Table("category", box=None, pad_edge=False, header_style="bold")
    for name in ("runs", "correct", "wrong", "unscored", "broken", "accuracy"):
        table.add_column(name, justify="right")
    fractions = []
    for category in CATEGORIES:
        in_category = [t for t in rows if t.task.category == category]
        if in_category:
            fraction = accuracy(in_category)
            fractions += [fraction] if fraction is not None else []
            table.add_row(category.replace("_", " "), *_counts(in_category), _percent(fraction))
    if rows:
        table.add_section()
        table.add_row(
            "macro (mean of categories)", *[""] * 5, _percent(sum(fractions) / len(fractions) if fractions else None), style="bold"
        )
        table.add_row("micro (all runs)", *_counts(rows), _percent(accuracy(rows)), style="bold")
    return table


def _counts(trials: Sequence[Trial]) -> list[str]:
    counts = [sum(t.headline == name for t in trials) for name in ("correct", "incorrect", "unscored", "infrastructure")]
    return [str(len(trials)), *(str(n) if n else "-" for n in counts)]


def _percent(fraction: float | None) -> str:
    return f"{100 * fraction:.1f} %" if fraction is not None else "-"


def unscored_lines(trials: Sequence[Trial]) -> list[str]:
    """Return lines about the runs without a verdict that only a judge can score. Such runs are excluded from accuracies."""
    pending = sum(needs_judgement(t) for t in trials)
    unparseable = sum(lacks_verdict(t) and not needs_judgement(t) for t in trials)
    lines = [f"unscored   {pending} not judged yet: scope bench rescore LOG --judge-url ..."] if pending else []
    return lines + ([f"unscored   {unparseable} without a verdict: the judge's replies were unparseable"] if unparseable else [])


def summary(evaluation: Evaluation) -> RenderableType:
    """Return the summary of an evaluation: scores, error modes, server failures and run durations."""
    trials, card = evaluation.trials, evaluation.card
    parts: list[RenderableType] = [Text(card.pair, style="bold"), category_table(trials)]
    if card.isolation is not None:
        parts.append(Text(f"agent      {card.isolation}: {ISOLATION_NOTES[card.isolation]}"))
    if note := baseline_note(evaluation):
        parts.append(Text(note, style="yellow"))
    modes = sorted(
        ((m, sum(t.error_mode == m for t in trials)) for m in {t.error_mode for t in trials if t.error_mode}), key=lambda x: -x[1]
    )
    parts += [Text(line) for line in unscored_lines(trials)]
    parts += [Text(f"judged     {note}")] if (note := other_judges_note(trials)) else []
    if modes:
        parts.append(Text("failed by  " + ", ".join(f"{mode.value.replace('_', ' ')} {count}" for mode, count in modes)))
    if events := server_events(trials):
        affected = sum(bool(t.server_events) for t in trials)
        parts.append(Text(f"servers    failed: {counts_text(events)} (in {affected} of {len(trials)} runs)"))
    durations_s = sorted(t.timings.total_s for t in trials if t.headline != "infrastructure")
    if durations_s:
        median, p95 = durations_s[len(durations_s) // 2], durations_s[math.ceil(0.95 * len(durations_s)) - 1]
        contention_note = " (runs shared the machine; measure latency with --latency)" if card.contended else ""
        parts.append(
            Text(f"a run      median {_run_duration(median)}, 95% within {_run_duration(p95)}{contention_note}", style="dim")
        )
    return Group(*parts)


def baseline_note(evaluation: Evaluation) -> str:
    """Return a note for scores that are not results of models, otherwise an empty string."""
    card = evaluation.card
    if card.planner.deterministic:
        return RULE_BASED_NOTE
    return GROUND_TRUTH_NOTE if card.perception.deterministic else ""


def _run_duration(seconds: float) -> str:
    return f"{seconds * 1000:.0f} ms" if seconds < 1 else duration_text(seconds)

"""What a person sees of an evaluation that goes on, and the table at its end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from typing import get_args

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from scope_ptz.bench.engine.context import Watcher
from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.judging.deciding_judge import other_judges_note
from scope_ptz.bench.judging.judgement_tally import not_judged, without_verdict
from scope_ptz.bench.scoring.trials import Evaluation, Trial
from scope_ptz.bench.tasks.task import Category
from scope_ptz.cli.bench_troubles import events_of, told

CATEGORIES: tuple[str, ...] = get_args(Category)
BROKEN_IN_A_ROW = 12
"""So many runs broken by infrastructure one after the other mean that going on is no use."""
TELL_EVERY_S = 15.0
SHOWN_RUNNING = 6


def clock(seconds: float) -> str:
    """A duration as people say it: 40 s, 12 min, 3 h 05 min."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"


class LiveTable(Watcher):
    """Counts runs as they end, and draws. ``stop`` is called when too many were broken in a row."""

    def __init__(self, console: Console, wanted: int, done: Sequence[Trial], title: str, stop: Callable[[], None]) -> None:
        self._console, self._wanted, self._title, self._stop = console, wanted, title, stop
        self._trials, self._before = {trial.sample: trial for trial in done}, len(done)
        self._running: dict[str, float] = {}
        self._began = self._told = time.monotonic()
        self._in_a_row = 0
        self.stopped = False
        self._live = Live(get_renderable=self._drawn, console=console, refresh_per_second=2) if console.is_terminal else None

    def __enter__(self) -> LiveTable:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def began(self, sample: str, entry: Entry) -> None:  # noqa: ARG002 - the watcher's signature
        self._running[sample] = time.monotonic()

    def ended(self, sample: str, trial: Trial) -> None:
        self._running.pop(sample, None)
        self._trials[sample] = trial
        broken = trial.headline == "infrastructure"
        self._in_a_row = self._in_a_row + 1 if broken else 0
        if self._in_a_row >= BROKEN_IN_A_ROW and not self.stopped:
            self.stopped = True
            self._stop()
        now = time.monotonic()
        if self._live is None and now - self._told >= TELL_EVERY_S:
            self._told = now
            self._console.print(self._line(), highlight=False)

    @property
    def trials(self) -> list[Trial]:
        """The runs that have ended."""
        return list(self._trials.values())

    def _left_s(self) -> float | None:
        fresh = len(self._trials) - self._before
        if fresh < 1:
            return None
        return (time.monotonic() - self._began) / fresh * (self._wanted - len(self._trials))

    def _line(self) -> str:
        left = self._left_s()
        right = sum(t.headline == "correct" for t in self._trials.values())
        broken = sum(t.headline == "infrastructure" for t in self._trials.values())
        when = f", about {clock(left)} left" if left is not None else ""
        open_ = sum(without_verdict(t) for t in self._trials.values())
        judged = f", {open_} not judged yet" if open_ else ""
        return f"{len(self._trials)} of {self._wanted} runs: {right} correct{judged}, {broken} broken by infrastructure{when}"

    def _drawn(self) -> RenderableType:
        rows = list(self._trials.values())
        head = Text.assemble((self._title, "bold"), "  ", self._line())
        bar = ProgressBar(total=self._wanted or 1, completed=len(rows), width=60)
        now = time.monotonic()
        longest = sorted(self._running.items(), key=lambda item: item[1])[:SHOWN_RUNNING]
        names = ", ".join(f"{name.rpartition('#')[0].partition('-')[2]} {now - since:.0f} s" for name, since in longest)
        more = len(self._running) - len(longest)
        running = Text(
            f"running  {names or 'nothing yet'}{f' and {more} more' if more > 0 else ''}", style="dim", overflow="ellipsis"
        )
        return Group(head, bar, category_table(rows), running)


def category_table(trials: Iterable[Trial]) -> Table:
    """Accuracy by category, macro and micro: correct among the runs that infrastructure did not break and that are scored."""
    rows = list(trials)
    table = Table("category", box=None, pad_edge=False, header_style="bold")
    for name in ("runs", "correct", "wrong", "unscored", "broken", "accuracy"):
        table.add_column(name, justify="right")
    shares = []
    for category in CATEGORIES:
        own = [t for t in rows if t.task.category == category]
        if own:
            share = accuracy(own)
            shares += [share] if share is not None else []
            table.add_row(category.replace("_", " "), *_counts(own), _percent(share))
    if rows:
        table.add_section()
        table.add_row(
            "macro (mean of categories)", *[""] * 5, _percent(sum(shares) / len(shares) if shares else None), style="bold"
        )
        table.add_row("micro (all runs)", *_counts(rows), _percent(accuracy(rows)), style="bold")
    return table


def accuracy(trials: Sequence[Trial]) -> float | None:
    """Correct among the runs that infrastructure did not break and that do not wait for a judge; None when none is left."""
    ran = [t for t in trials if t.headline != "infrastructure" and not without_verdict(t)]
    return sum(t.headline == "correct" for t in ran) / len(ran) if ran else None


def macro(trials: Sequence[Trial]) -> float | None:
    """The unweighted mean over the categories that have a share at all."""
    groups = [[t for t in trials if t.task.category == category] for category in CATEGORIES]
    shares = [share for share in (accuracy(group) for group in groups if group) if share is not None]
    return sum(shares) / len(shares) if shares else None


def _counts(trials: Sequence[Trial]) -> list[str]:
    by = [sum(t.headline == name for t in trials) for name in ("correct", "incorrect", "unscored", "infrastructure")]
    return [str(len(trials)), *(str(n) if n else "-" for n in by)]


def _percent(share: float | None) -> str:
    return f"{100 * share:.1f} %" if share is not None else "-"


def waiting(trials: Sequence[Trial]) -> list[str]:
    """What is said of runs that only a judge can score and that have no verdict: they are in no share."""
    fresh, mute = sum(not_judged(t) for t in trials), sum(without_verdict(t) and not not_judged(t) for t in trials)
    lines = [f"not scored {fresh} not judged yet: scope bench rescore LOG --judge-url ..."] if fresh else []
    return lines + ([f"not scored {mute} without a verdict: the judge's replies were unparseable"] if mute else [])


def summary(evaluation: Evaluation) -> RenderableType:
    """The table at the end of an evaluation, with why runs failed and what they took."""
    trials, card = evaluation.trials, evaluation.card
    parts: list[RenderableType] = [Text(card.pair, style="bold"), category_table(trials)]
    modes = sorted(
        ((m, sum(t.error_mode == m for t in trials)) for m in {t.error_mode for t in trials if t.error_mode}), key=lambda x: -x[1]
    )
    parts += [Text(line) for line in waiting(trials)]
    parts += [Text(f"judged     {several}")] if (several := other_judges_note(trials)) else []
    if modes:
        parts.append(Text("failed by  " + ", ".join(f"{mode.value.replace('_', ' ')} {count}" for mode, count in modes)))
    if events := events_of(trials):
        having = sum(bool(t.server_events) for t in trials)
        parts.append(Text(f"servers    failed: {told(events)} (in {having} of {len(trials)} runs)"))
    timed = sorted(t.timings.total_s for t in trials if t.headline != "infrastructure")
    if timed:
        middle, most = timed[len(timed) // 2], timed[math.ceil(0.95 * len(timed)) - 1]
        alone = " (runs shared the machine: measure latency with --latency)" if card.contended else ""
        parts.append(Text(f"a run      median {clock(middle)}, 95% within {clock(most)}{alone}", style="dim"))
    if not card.ranked:
        parts.append(
            Text("Deterministic planner or ground-truth eyes: a check of the benchmark, no result of a model.", style="dim")
        )
    return Group(*parts)

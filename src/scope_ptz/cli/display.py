"""Terminal output: strings that are safe to print, the live steps and the result of a run, and progress bars."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from rich.padding import Padding
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console
    from rich.progress import TaskID
    from rich.status import Status

    from scope_ptz.agent.records import Called, Decided, Ended, Started
    from scope_ptz.agent.timing import Timings
    from scope_ptz.planner.base import ToolCall

MAX_SHOWN_CHARS = 200  # longer instructions and arguments are truncated when printed
MAX_PLANNED = 12  # maximum number of dry-run commands to print
MAX_MESSAGE_CHARS = 2000  # longer tool messages are truncated when printed
_TRUTH_SOURCE = " (Source: the simulator's ground truth.)"
_OUTCOME_TITLES = {
    "answered": ("Answer", "bold green"),
    "clarification": ("Question", "bold yellow"),
    "refused": ("Refused", "bold yellow"),
    "step_limit": ("Step limit", "bold red"),
    "budget": ("Budget spent", "bold red"),
    "planner_error": ("Planner failed", "bold red"),
    "camera_error": ("Camera failed", "bold red"),
    "cancelled": ("Cancelled", "bold red"),
}


def sanitize(text: str) -> str:
    """Replace control characters in text, so that output from models and scenes cannot control the terminal."""
    return "".join(c if c.isprintable() or c == "\n" else " " for c in text)


def shorten(text: str, limit: int = MAX_SHOWN_CHARS) -> str:
    """Truncate text to ``limit`` characters, and append its full length if it was longer."""
    return text if len(text) <= limit else f"{text[:limit].rstrip()}… ({len(text)} characters)"


def arguments_text(arguments: dict[str, Any]) -> str:
    """Format arguments for display, such as ``pan_deg=15, view=current``."""
    parts = (f"{k}={v if isinstance(v, str) and v.isprintable() else json.dumps(v)}" for k, v in arguments.items())
    return sanitize(shorten(", ".join(parts)))


def seconds_text(value: float) -> str:
    """Format a duration in seconds or milliseconds."""
    return f"{value:.1f} s" if value >= 1 else f"{value * 1000:.0f} ms"


class LiveView:
    """A run listener that prints each step as it happens."""

    def __init__(self, console: Console) -> None:
        self.console = console
        self._status: Status | None = None

    def __call__(self, record: Started | Decided | Called | Ended) -> None:
        from scope_ptz.agent.records import Called, Decided, Started
        from scope_ptz.planner.base import CallTools

        self._show_status(None)
        match record:
            case Started():
                self._show_start(record)
            case Decided(decision=CallTools(calls=calls)):
                self._show_status(calls[0])
            case Called():
                self._show_call(record)

    def _show_status(self, call: ToolCall | None) -> None:
        if self._status is not None:
            self._status.stop()
            self._status = None
        if call is not None and self.console.is_terminal:
            line = Text.assemble("  ", (sanitize(call.name), "bold"), "  ", (arguments_text(call.arguments), "dim"))
            self._status = self.console.status(line, spinner="dots")
            self._status.start()

    def _show_start(self, record: Started) -> None:
        self.console.print(Text.assemble(("› ", "bold cyan"), (sanitize(shorten(record.instruction)), "bold")))
        components = f"{record.camera} · planner {record.planner} · perception {record.perception}"
        self.console.print(Padding(Text(sanitize(components), style="dim"), (0, 0, 0, 2)))
        self.console.print()

    def _show_call(self, record: Called) -> None:
        call, outcome = record.outcome.call, record.outcome
        table = Table.grid(padding=(0, 2, 0, 0), expand=True)
        table.add_column(justify="right", width=3, no_wrap=True)
        table.add_column(width=14, no_wrap=True)
        table.add_column(ratio=1)
        table.add_column(justify="right", no_wrap=True)
        table.add_row(
            Text(str(record.step), style="cyan"),
            Text(sanitize(call.name), style="bold"),
            Text(arguments_text(call.arguments)),
            Text(seconds_text(record.timings.total_s), style="dim"),
        )
        if outcome.error is not None:
            table.add_row("", "", Text(sanitize(shorten(outcome.error)), style="red"), "")
        elif outcome.result is not None:
            table.add_row("", "", Text(sanitize(shorten(str(outcome.result["message"]), MAX_MESSAGE_CHARS)), style="green"), "")
        self.console.print(table)


class BriefView(LiveView):
    """A run listener that prints one line for each step, with its result only where the answer may not repeat it.

    Args:
        console: The console to print on.
        echoes: Whether to print the instruction, which an interactive prompt already shows.
    """

    def __init__(self, console: Console, *, echoes: bool) -> None:
        super().__init__(console)
        self._echoes = echoes

    def _show_start(self, record: Started) -> None:
        if self._echoes:
            self.console.print(Text.assemble(("› ", "bold cyan"), (sanitize(shorten(record.instruction)), "bold")))

    def _show_call(self, record: Called) -> None:
        call, outcome = record.outcome.call, record.outcome
        line = Text.assemble((f"{record.step:>3}  ", "cyan"), (sanitize(call.name), "bold"), "  ", arguments_text(call.arguments))
        if outcome.error is not None:
            line.append(f": {_brief_error(outcome.error)}", style="red")
        elif outcome.result is not None and (result := _brief_result(outcome.result)):
            line.append(f": {result}", style="green")
        self.console.print(line)


def _brief_error(error: str) -> str:
    """Return the error of a step. That perception did not understand it is said in two words, because the answer explains it."""
    from scope_ptz.planner.grammar.execution.answer_sentences import is_not_understood

    return "not understood" if is_not_understood(error) else sanitize(shorten(error))


def _brief_result(result: dict[str, Any]) -> str:
    """Return the result of a step in a word or two: a count, or whether something was found. Empty for other results."""
    if isinstance(count := result.get("count"), int):
        return str(count)
    found = result.get("found")
    return "" if found is None else "found" if found else "not found"


def show_brief_end(console: Console, ended: Ended, folder: Path | None = None) -> None:
    """Print the answer and, with a run folder, one line with the duration and the path.

    The note that names the simulator's ground truth as the source is left out: a chat states it once, at its start.
    """
    title, style = _OUTCOME_TITLES[ended.outcome]
    console.print(Text.assemble((f"{title}: ", style), (sanitize(ended.text.removesuffix(_TRUTH_SOURCE)), "bold")))
    if folder is not None:
        console.print(Text(f"{seconds_text(ended.timings.total_s)} · {folder}", style="dim"), soft_wrap=True)
    console.print()


def show_end(console: Console, ended: Ended, note: str = "", folder: Path | None = None, filmstrip: Path | None = None) -> None:
    """Print the answer, the perception note, the timings, and the paths of the run folder and the filmstrip.

    Args:
        console: The console to print on.
        ended: The run's last record.
        note: A note about the perception backend, if it is not a model; otherwise empty.
        folder: The run folder. If None, only the answer and the note are printed.
        filmstrip: The run's filmstrip, if there is one.
    """
    title, style = _OUTCOME_TITLES[ended.outcome]
    console.print()
    console.print(Text.assemble((f"{title}: ", style), (sanitize(ended.text), "bold")))
    if note:
        console.print(Text(note, style="yellow"))
    if folder is None:
        return
    console.print(Text(timings_text(ended.timings), style="dim"))
    console.print(Text(f"Run folder: {folder}", style="dim"), soft_wrap=True)
    if filmstrip is not None:
        console.print(Text(f"Filmstrip:  {filmstrip}", style="dim"), soft_wrap=True)


def show_planned(console: Console, commands: list[str]) -> None:
    """Print the commands that a dry run did not execute. A long list is shortened to the first commands and the last command.

    Args:
        console: The console to print on.
        commands: The commands, one sentence each.
    """
    console.print()
    console.print(Text("Dry run: the camera has not moved." + (" Planned commands:" if commands else ""), style="yellow"))
    shown = commands if len(commands) <= MAX_PLANNED else commands[: MAX_PLANNED - 1]
    for sentence in shown:
        console.print(Text(f"  {sanitize(sentence)}"))
    if len(shown) < len(commands):
        console.print(Text(f"  ... and {len(commands) - len(shown) - 1} more, ending with: {sanitize(commands[-1])}"))


def timings_text(timings: Timings) -> str:
    """Return a sentence with the total duration and its breakdown by stage."""
    parts = (("planner", timings.planner_s), ("perception", timings.perception_s), ("camera", timings.camera_s))
    breakdown = ", ".join(f"{name} {seconds_text(value)}" for name, value in (*parts, ("rendering", timings.render_s)))
    return f"{seconds_text(timings.total_s)} in total: {breakdown}."


class ProgressBars:
    """Progress bars with the remaining time, one for each part of a task.

    Args:
        console: The console to print on.
        enabled: Whether to show the bars.
        description: Format of the text before each bar.
    """

    def __init__(self, console: Console, *, enabled: bool = True, description: str = "{task.description}") -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

        self._progress = Progress(
            TextColumn(description), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn(),
            console=console, disable=not enabled,
        )  # fmt: skip
        self._tasks: dict[str, TaskID] = {}

    def __enter__(self) -> ProgressBars:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def __call__(self, part: str, done: int, total: int, seconds: float = 0.0) -> None:  # noqa: ARG002 - the bars measure time
        """Show how much of a part is done."""
        if part not in self._tasks:
            self._tasks[part] = self._progress.add_task(part, total=total)
        self._progress.update(self._tasks[part], completed=done, total=total)

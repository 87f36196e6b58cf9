"""Export runs as JSON data, as run folders, or as conversations for fine-tuning a planner."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import IO, Any, Literal, get_args

from scope_ptz.agent.trace import Trace, read_trace
from scope_ptz.errors import InputError, OutputError, TraceError
from scope_ptz.geometry import Limits
from scope_ptz.planner.base import Briefing, Exchange, State
from scope_ptz.store.database import Database
from scope_ptz.store.feedback import feedback_on
from scope_ptz.store.queries import load_run

ExportFormat = Literal["jsonl", "chat", "zip"]
FEEDBACK_FILE = "feedback.jsonl"
EXPORT_FORMATS: tuple[str, ...] = get_args(ExportFormat)
"""The formats of exported runs.

- ``jsonl``: each line contains a run, its calls and its feedback.
- ``chat``: each line contains ``messages`` and ``tools`` in the format for fine-tuning chat models. Only runs that ended with an
  answer, a question or a refusal are exported.
- ``zip``: an archive of the run folders, and ``feedback.jsonl`` with the ratings of whole runs for ``scope bench generate``.
"""


def export_runs(database: Database, root: Path, runs: Iterable[str], out: Path, kind: ExportFormat) -> int:
    """Write runs to a file. An existing file is replaced only when the new one is complete.

    Returns:
        Number of runs that were written.

    Raises:
        InputError: The format is unknown.
        UnknownNameError: There is no such run.
        OutputError: The file cannot be written.
    """
    if kind not in EXPORT_FORMATS:
        raise InputError(f"There is no export format '{kind}'. Use one of: {', '.join(EXPORT_FORMATS)}.")
    if kind == "zip":
        return write_atomically(out, lambda file: _write_zip(database, root, runs, file))
    return write_atomically(out, lambda file: _write_lines(_lines(database, root, runs, kind), file))


def write_atomically(out: Path, write: Callable[[IO[bytes]], int]) -> int:
    """Write a file and return the number of runs in it. An existing file is replaced only when the new one is complete.

    Raises:
        OutputError: The file cannot be written.
    """
    partial_file = out.with_name(f".{out.name}.{os.getpid()}.part")
    try:
        with partial_file.open("wb") as file:
            count = write(file)
        partial_file.replace(out)
    except OSError as error:
        raise OutputError(f"{out} cannot be written: {error.strerror or error}. Choose another file.") from error
    finally:
        partial_file.unlink(missing_ok=True)
    return count


def _lines(database: Database, root: Path, runs: Iterable[str], kind: ExportFormat) -> Iterator[dict[str, Any]]:
    make_line: Callable[[Database, Path, str], dict[str, Any] | None] = _chat_line if kind == "chat" else _data_line
    return (line for run_id in runs if (line := make_line(database, root, run_id)) is not None)


def _write_lines(lines: Iterable[dict[str, Any]], file: IO[bytes]) -> int:
    count = 0
    for count, line in enumerate(lines, 1):  # noqa: B007 - the last value is the number of lines
        file.write(json.dumps(line, ensure_ascii=False).encode() + b"\n")
    return count


def _write_zip(database: Database, root: Path, runs: Iterable[str], file: IO[bytes]) -> int:
    count, ratings = 0, list[dict[str, str]]()
    # Pictures are already compressed, and traces are small.
    with zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as archive:
        for run_id in runs:
            folder = root / run_id
            for path in sorted(folder.rglob("*")):
                if path.is_file() and not path.is_symlink():
                    archive.write(path, f"{run_id}/{path.relative_to(folder).as_posix()}")
            count += folder.is_dir()
            ratings += _ratings(database, run_id) if folder.is_dir() else []
        if ratings:
            archive.writestr(FEEDBACK_FILE, "".join(f"{json.dumps(rating, ensure_ascii=False)}\n" for rating in ratings))
    return count


def _ratings(database: Database, run_id: str) -> list[dict[str, str]]:
    """Return a list with the newest rating of a whole run, for ``scope bench generate``. It is empty if there is no rating."""
    rated = [entry for entry in feedback_on(database, run_id) if entry.position is None and entry.rating]
    return [{"run": run_id, "rating": "good" if entry.rating > 0 else "bad", "note": entry.comment} for entry in rated[-1:]]


def _data_line(database: Database, root: Path, run_id: str) -> dict[str, Any]:  # noqa: ARG001 - all formats share this signature
    return run_data(database, run_id)


def run_data(database: Database, run_id: str) -> dict[str, Any]:
    """Return a run with its calls, the names of its frames and its feedback, as JSON.

    Raises:
        UnknownNameError: There is no such run.
    """
    stored = load_run(database, run_id)
    return {
        **stored.run.model_dump(mode="json"),
        "step_list": [step.model_dump(mode="json") for step in stored.steps],
        "frames": [frame.name for frame in stored.frames],
        "feedback": [entry.model_dump(mode="json", exclude={"run"}) for entry in feedback_on(database, run_id)],
    }


def _chat_line(database: Database, root: Path, run_id: str) -> dict[str, Any] | None:
    try:
        trace = read_trace(root / run_id)
    except TraceError:
        return None
    if trace.ended is None or trace.ended.outcome not in ("answered", "clarification", "refused"):
        return None
    ratings = [{"rating": entry.rating, "call": entry.position} for entry in feedback_on(database, run_id)]
    return {**chat_conversation(trace), "run": run_id, "ratings": ratings}


def chat_conversation(trace: Trace) -> dict[str, Any]:
    """Convert a run to a chat model's conversation: system prompt, instruction, tool calls, their results, and the answer."""
    from scope_ptz.planner.chat.chat_messages import build_messages
    from scope_ptz.planner.chat.prompts import load_prompt
    from scope_ptz.tools.registry import schemas

    started = trace.started
    briefing = Briefing(presets=started.presets, pose=started.pose.pose(), limits=Limits())
    state = State(
        instruction=started.instruction, briefing=briefing, history=exchanges_of(trace), conversation=started.conversation
    )
    messages = build_messages(state, load_prompt())
    if trace.ended is not None:
        messages.append({"role": "assistant", "content": trace.ended.text})
    return {"messages": messages, "tools": schemas()}


def exchanges_of(trace: Trace) -> tuple[Exchange, ...]:
    """Convert the steps of a recorded run to the history that a planner receives."""
    thoughts = {decided.step: getattr(decided.decision, "thought", "") for decided in trace.decisions}
    steps: dict[int, list[Any]] = {}
    for call in trace.calls:
        if call.fault != "cancelled":
            steps.setdefault(call.step, []).append(call.outcome)
    return tuple(Exchange(outcomes=tuple(outcomes), thought=thoughts.get(step, "")) for step, outcomes in sorted(steps.items()))

"""Wrappers for the private Inspect AI functions that this package uses.

The version of Inspect AI is pinned exactly. Before an upgrade, check whether the reason for each wrapper still applies:

- ``silence_display``: SCOPE shows its own table, and ``eval_async`` has no argument that turns off Inspect's display.
- ``header_context``: without it, pydantic assigns new ids to the messages in a stored header. The public log readers cannot be
  used, because they patch asyncio for the whole program if an event loop is running.
- ``attachment_reference``: a sample stores each picture once, under the hash of its data URL.
- ``recover_log``: the public ``recover_eval_log`` starts its own event loop.
- ``resumed_task``: ``eval_async`` reuses samples from an earlier log only through a ``PreviousTask``. ``eval_retry`` would create
  the task and the models from their names, without the evaluation context.
- ``recorder``: the public functions load the whole log into memory, whereas the recorder handles one sample at a time.
"""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Any

from inspect_ai import Task
from inspect_ai._eval.loader import resolve_task_args
from inspect_ai._eval.task.task import PreviousTask
from inspect_ai._util.constants import get_deserializing_context
from inspect_ai._util.hash import mm3_hash
from inspect_ai.log import EvalLog, EvalLogInfo, RecoveryNotAvailable
from inspect_ai.log._condense import ATTACHMENT_PROTOCOL
from inspect_ai.log._recorders.create import create_recorder_for_location
from inspect_ai.log._recorders.recorder import Recorder
from inspect_ai.log._recover import recover_eval_log_async
from inspect_ai.util._display import init_display_type

__all__ = [
    "ATTACHMENT_PROTOCOL", "PreviousTask", "Recorder", "attachment_reference", "header_context", "recorder", "recover_log",
    "resumed_task", "silence_display",
]  # fmt: skip


def silence_display() -> None:
    """Turn off Inspect's own display."""
    init_display_type("none")


def header_context() -> dict[str, Any]:
    """Return the pydantic validation context for reading a stored header."""
    return get_deserializing_context()


def attachment_reference(content: str) -> str:
    """Return the reference to a text or picture that is stored once as an attachment of the sample."""
    return ATTACHMENT_PROTOCOL + mm3_hash(content)


async def recover_log(path: Path) -> None:
    """Write the finished samples of a killed evaluation to a new log in the same folder, if there are any."""
    with suppress(RecoveryNotAvailable):
        await recover_eval_log_async(str(path), cleanup=True)


def resumed_task(task: Task, header: EvalLog, info: EvalLogInfo | None) -> PreviousTask:
    """Return a task that reuses the samples from an earlier log.

    Args:
        task: The task to run.
        header: The earlier log, with or without samples.
        info: Location of the earlier log; required if ``header`` does not contain the samples.
    """
    return PreviousTask(
        id=header.eval.task_id, task=task, task_args=resolve_task_args(task), model=None, model_roles=None, sandbox=None,
        log=header, log_info=info,
    )  # fmt: skip


def recorder(log: Path, folder: Path) -> Recorder:
    """Return a recorder that reads or writes a log one sample at a time."""
    return create_recorder_for_location(str(log), str(folder))

"""The host: its folder, its participants, and one evaluation for each participant."""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import json
import os
import re
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.bench.engine.file_lock import lock_file
from scope_ptz.errors import InputError, OutputError
from scope_ptz.serve.bench_host.evaluation import HostedEvaluation, NotReadyError
from scope_ptz.serve.bench_host.journal import Journal
from scope_ptz.serve.bench_host.links import OpenLink, ProcessLink
from scope_ptz.serve.bench_host.wire import EvaluationSettings, Failed, Ready, WorkerSettings
from scope_ptz.serve.security.tokens import TokenFile

STATE_FILE = "host.json"
LOCK_FILE = ".host.lock"
PARTICIPANTS_FILE = "participants.json"
SEED_BYTES = 32
NAME_DIGEST_CHARS = 8
POLL_S = 0.5
"""Seconds between checks for evaluations that have finished."""


class _State(BaseModel):
    """The contents of the host's state file.

    Attributes:
        seed: Secret from which every participant's task order is derived.
        settings: The evaluation settings.
        tasks_sha256: Digest of the task file; empty for a published split.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    version: int = Field(default=1, ge=1, le=1)
    seed: str = Field(repr=False, min_length=2 * SEED_BYTES)
    settings: EvaluationSettings
    tasks_sha256: str


class Host:
    """Evaluates the participants in one folder.

    Args:
        folder: The host's folder, with the secret seed, tokens, journals, logs and submissions. An existing one is resumed.
        settings: The evaluation settings.
        key: Private key file for signing submissions.
        open_link: Function that starts a worker.
        fail_unfinished: Whether to fail all unfinished runs, so that all evaluations can be finished without their participants.
        notify: Function that receives a line of text when an evaluation is finished.

    Raises:
        InputError: The folder belongs to a host with other settings.
        OutputError: The folder cannot be written to.
    """

    def __init__(
        self,
        folder: Path,
        settings: EvaluationSettings,
        key: Path,
        *,
        open_link: OpenLink = ProcessLink.start,
        fail_unfinished: bool = False,
        notify: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.folder, self.settings, self.key = folder.resolve(), settings, key.resolve()
        self._open_link, self._fail_unfinished, self._notify = open_link, fail_unfinished, notify
        self._evaluations: dict[str, HostedEvaluation] = {}
        self._state = _load_state(self.folder, settings)
        self.tokens = TokenFile(participants_file(self.folder))
        self.closing = asyncio.Event()

    async def check(self) -> int:
        """Check the settings in a worker, and return the number of runs in each evaluation.

        Raises:
            InputError: The tasks, the scenes, the perception or the key cannot be used.
            NotReadyError: The worker did not start.
        """
        settings = self._worker_settings("check").model_copy(update={"check_only": True})
        link = await self._open_link(settings)
        try:
            while (event := await link.receive()) is not None:
                if isinstance(event, Ready):
                    return event.runs
                if isinstance(event, Failed):
                    raise InputError(event.message)
        finally:
            await link.close()
        raise NotReadyError("The process that runs the evaluation did not start.")

    def evaluation(self, participant: str) -> HostedEvaluation:
        """Return a participant's evaluation. The caller must check that the name is registered."""
        if participant not in self._evaluations:
            settings = self._worker_settings(participant)
            self._evaluations[participant] = HostedEvaluation(
                settings, Journal(settings.folder), self._open_link, fail_unfinished=self._fail_unfinished
            )
        return self._evaluations[participant]

    async def wait_until_finished(self, *, start: bool) -> None:
        """Wait until every registered participant's evaluation has finished or failed.

        Args:
            start: Whether to start all evaluations instead of waiting for the participants to begin.
        """
        reported: set[str] = set()
        while True:
            names = [token.name for token in TokenFile(self.tokens.path).tokens]
            evaluations = {name: self.evaluation(name) for name in names}
            for name, evaluation in evaluations.items():
                if start:
                    evaluation.start()
                if evaluation.finished and name not in reported:
                    reported.add(name)
                    self._notify(f"{name}: finished, {evaluation.journal.submission}")
            if names and all(evaluation.finished or evaluation.phase == "failed" for evaluation in evaluations.values()):
                return
            await asyncio.sleep(POLL_S)

    async def close(self) -> None:
        """Stop all workers. The evaluations can be resumed later."""
        self.closing.set()
        await asyncio.gather(*(evaluation.close() for evaluation in self._evaluations.values()))
        self._evaluations.clear()

    def _worker_settings(self, participant: str) -> WorkerSettings:
        seed = hmac.new(self._state.seed.encode(), participant.encode(), hashlib.sha256).hexdigest()
        return WorkerSettings(
            evaluation=self.settings, participant=participant, folder=self.folder / folder_name(participant), key=self.key,
            order_seed=seed,
        )  # fmt: skip


def participants_file(folder: Path) -> Path:
    """Return the path of the file with the participants' tokens."""
    return folder / PARTICIPANTS_FILE


def folder_name(participant: str) -> str:
    """Return a participant's folder name, which is unique even on file systems that ignore case."""
    digest = hashlib.sha256(participant.encode()).hexdigest()[:NAME_DIGEST_CHARS]
    return f"{re.sub('[^A-Za-z0-9-]', '_', participant)}-{digest}"


@contextmanager
def lock_folder(folder: Path) -> Iterator[None]:
    """Lock a host's folder, so that a second host cannot use it at the same time.

    Raises:
        InputError: Another host uses the folder.
        OutputError: The folder cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        lock = (folder / LOCK_FILE).open("w")
    except OSError as error:
        raise OutputError(f"The folder {folder} cannot be written to: {error.strerror}. Choose another one with --out.") from error
    with lock:
        if not lock_file(lock):
            raise InputError(f"Another host is using {folder}. Stop it first, or choose another folder with --out.")
        yield


def _load_state(folder: Path, settings: EvaluationSettings) -> _State:
    """Read a folder's state, or create it with a new secret seed. Raises ``InputError`` and ``OutputError``."""
    path, digest = folder / STATE_FILE, _task_file_digest(settings.tasks)
    try:
        state = _State.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        state = _State(seed=secrets.token_hex(SEED_BYTES), settings=settings, tasks_sha256=digest)
        _write_private(path, json.dumps(state.model_dump(mode="json"), indent=1))
        return state
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    except ValidationError:
        raise InputError(f"{path} is damaged. Restore it from a backup, or choose another folder with --out.") from None
    if (state.settings, state.tasks_sha256) != (settings, digest):
        raise InputError(f"{folder} belongs to a host with other tasks or settings. Use its options, or choose another folder.")
    return state


def _task_file_digest(tasks: str) -> str:
    path = Path(tasks)
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
    except OSError as error:
        raise InputError(f"The task file {path} cannot be read: {error.strerror}.") from error


def _write_private(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as file:
            file.write(text + "\n")
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror}. Choose another folder with --out.") from error

"""Read the traces and pictures of individual runs from logs. Inspect AI is not imported, because the import takes seconds."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

from pydantic import ValidationError
from pydantic_core import from_json

from scope_ptz.agent.trace import Trace
from scope_ptz.bench.engine.recording.picture_store import jpeg_of
from scope_ptz.bench.engine.stored_run import STORE, StoredRun, sample_name, trace_of
from scope_ptz.bench.scoring.episode import PresetViewpoints
from scope_ptz.errors import TraceError
from scope_ptz.regular_files import check_regular_file

if sys.version_info < (3, 14):
    import zipfile_zstd  # type: ignore[import-untyped,unused-ignore]  # noqa: F401 - lets zipfile read logs, which use Zstandard

ATTACHMENT = "attachment://"
"""Prefix of references to attachments of the same sample."""
_SAMPLES = "samples/"


@dataclass(frozen=True, slots=True)
class SampleFiles:
    """The trace and pictures of a run in a log.

    Attributes:
        trace: The trace of the run.
        places: The viewpoints of the scene's presets.
        references: References to the pictures, by the picture names in the trace.
        attachments: The sample's attachments by reference.
    """

    trace: Trace
    places: PresetViewpoints
    references: Mapping[str, str]
    attachments: Mapping[str, str]

    def picture(self, name: str) -> bytes | None:
        """Return the JPEG data of a picture by its name in the trace; None if the picture was not stored."""
        data = self.attachments.get(self.references.get(name, "").removeprefix(ATTACHMENT))
        return jpeg_of(data) if data is not None else None


def open_sample(path: Path, sample: str) -> SampleFiles:
    """Return the trace and pictures of a run in a log.

    Args:
        path: The log.
        sample: Name of the run's sample, as in ``Trial.sample``.

    Raises:
        TraceError: The log cannot be read, or it does not contain the run.
    """
    task, _, epoch = sample.rpartition("#")
    with convert_read_errors(path):
        content = next(
            (row for row in samples(path, f"{task}_epoch_{epoch}") if sample_name(row["id"], row["epoch"]) == sample), None
        )
        if content is None:
            raise TraceError(f"The log {path} does not contain the run {sample}.")
        stored_run = stored_run_in(content)
        trace = trace_of(stored_run.trace, path) if stored_run is not None else None
        if stored_run is None or trace is None:
            raise TraceError(f"The run {sample} of {path} never began, so it has no trace.")
        return SampleFiles(trace, stored_run.places, stored_run.pictures, content.get("attachments", {}))


@contextmanager
def convert_read_errors(path: Path) -> Iterator[None]:
    """Convert errors that occur while a log is read to ``TraceError``, with the path of the log."""
    try:
        check_regular_file(path)
        yield
    except TraceError:
        raise
    except FileNotFoundError:
        raise TraceError(f"The log {path} does not exist.") from None
    except OSError as error:
        raise TraceError(f"The log {path} cannot be read: {error.strerror or error}.") from error
    except (BadZipFile, ValidationError, ValueError, KeyError, EOFError, TypeError, AttributeError, NotImplementedError) as error:
        raise TraceError(
            f"{path} is not the log of an evaluation, or it is damaged ({type(error).__name__}: {str(error)[:200]})."
        ) from error


def samples(path: Path, name: str | None = None) -> Iterator[dict[str, Any]]:
    """Yield the samples in a log as JSON data. With ``name``, yield only the sample in ``samples/NAME.json``.

    A log is a ZIP archive. If it contains several files with the same name, the last one is read.
    """
    with ZipFile(path) as archive:
        requested = f"{_SAMPLES}{name}.json" if name else None
        for member in dict.fromkeys(n for n in archive.namelist() if n.startswith(_SAMPLES)):
            if requested is None or member == requested:
                sample = from_json(archive.read(member))
                if not isinstance(sample, dict):
                    raise TraceError(f"The log {path} is damaged: {member} is not a sample.")
                yield sample


def sample_count(path: Path) -> int:
    """Return the number of samples in a log."""
    with ZipFile(path) as archive:
        return len({name for name in archive.namelist() if name.startswith(_SAMPLES)})


def stored_run_in(sample: Mapping[str, Any]) -> StoredRun | None:
    """Return the run stored in a sample; None if no run is stored.

    If the process was killed during the run, the data is taken from the last event that changed the sample's store.
    """
    attachments = sample.get("attachments", {})
    stored = (sample.get("store") or {}).get(STORE)
    if stored is None:
        changes = (c for e in sample.get("events") or () if e.get("event") == "store" for c in e.get("changes") or ())
        stored = next((c["value"] for c in reversed(list(changes)) if c.get("path") == f"/{STORE}"), None)
    if stored is None:
        return None
    stored_run = StoredRun.from_store(stored)
    if stored_run.trace.startswith(ATTACHMENT):
        return replace(stored_run, trace=attachments[stored_run.trace.removeprefix(ATTACHMENT)])
    return stored_run

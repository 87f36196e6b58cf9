"""Read the runs in a log with their stored data, for verification and submissions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from scope_ptz.bench.engine.entries import Entry
from scope_ptz.bench.engine.recording.picture_store import jpeg_of
from scope_ptz.bench.engine.sample_files import ATTACHMENT, convert_read_errors, samples, stored_run_in
from scope_ptz.bench.engine.stored_run import StoredRun
from scope_ptz.bench.engine.traces.scored_trials import published_entry
from scope_ptz.bench.engine.traces.verification import RunToVerify


def read_runs(path: Path) -> Iterator[RunToVerify]:
    """Yield the runs in a log, one sample at a time. A published task replaces its copy in the log.

    Raises:
        TraceError: The log does not exist or is damaged.
    """
    with convert_read_errors(path):
        for sample in samples(path):
            entry, _ = published_entry(Entry.of_metadata(sample["metadata"]))
            stored_run = stored_run_in(sample) or StoredRun("", {}, "")
            attachments: Mapping[str, str] = sample.get("attachments") or {}
            yield RunToVerify(entry, int(sample["epoch"]), stored_run, _Pictures(stored_run.pictures, attachments).jpeg)


class _Pictures:
    """The pictures of a sample, by their names in the trace."""

    def __init__(self, references: Mapping[str, Any], attachments: Mapping[str, str]) -> None:
        self._references, self._attachments = references, attachments

    def jpeg(self, name: str) -> bytes | None:
        """Return the JPEG data of a picture; None if the picture was not stored or is damaged."""
        data = self._attachments.get(str(self._references.get(name, "")).removeprefix(ATTACHMENT))
        try:
            return jpeg_of(data) if data is not None else None
        except ValueError:
            return None

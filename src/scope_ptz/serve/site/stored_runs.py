"""Read stored runs: their traces, records and pictures."""

from __future__ import annotations

from functools import partial

from scope_ptz.agent.trace import Trace, picture_names, picture_path, read_trace
from scope_ptz.errors import TraceError, UnknownNameError
from scope_ptz.serve.site.marks import call_for_picture, draw_marks, marks_of
from scope_ptz.serve.site.run_handle import Record
from scope_ptz.serve.site.site import Site


async def trace_of_run(site: Site, run_id: str) -> Trace:
    """Return a run's trace.

    Raises:
        UnknownNameError: There is no such run.
        TraceError: The run's trace is damaged.
    """
    folder = site.library.store.folder(run_id)
    if not await site.library.in_thread((folder / "trace.jsonl").is_file):
        raise UnknownNameError("run", run_id[:120], ())
    return await site.library.in_thread(partial(read_trace, folder))


def records_of(trace: Trace) -> list[Record]:
    """Return a trace's records in the order in which they were written: a step's calls follow its decision."""
    records: list[Record] = [trace.started]
    for decision in trace.decisions:
        records.append(decision)
        records += [call for call in trace.calls if call.step == decision.step]
    return [*records, *([] if trace.ended is None else [trace.ended])]


async def stored_picture(site: Site, run_id: str, name: str, *, marks: bool = False) -> bytes:
    """Return an encoded picture from a run, as it was stored or, with ``marks``, as a JPEG with numbered boxes.

    Args:
        site: The site.
        run_id: The run's id.
        name: The picture's name in the run folder, such as ``frames/001-view.jpg``.
        marks: Whether to draw the detections on the picture.

    Raises:
        UnknownNameError: There is no such run, or its trace does not name such a picture.
        TraceError: The trace is damaged, or the file is missing.
    """
    trace = await trace_of_run(site, run_id)
    if name not in picture_names(trace):
        raise UnknownNameError("picture", name[:80], ())

    def read() -> bytes:
        try:
            data = picture_path(trace.folder, name).read_bytes()
        except OSError as error:
            raise TraceError(f"The picture file {name} is missing from this run.") from error
        return draw_marks(data, marks_of(call_for_picture(trace, name), name)) if marks else data

    return await site.library.in_thread(read)

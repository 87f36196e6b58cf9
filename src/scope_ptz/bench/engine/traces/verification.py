"""Verify runs: repeat their calls in the simulator, and compare poses, ground-truth replies and frames with the recorded ones.

Verification shows that a trace is possible. It cannot show that the planner named in the trace made the decisions.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import anyio
from anyio import to_thread

from scope_ptz.agent.resimulation import Resimulation, picture_pairs, resimulate
from scope_ptz.agent.store import NoImages
from scope_ptz.agent.trace import Trace
from scope_ptz.bench.engine.context import TrueCount
from scope_ptz.bench.engine.entries import Entry, OpenScene
from scope_ptz.bench.engine.recording.picture_store import PictureStore, jpeg_of
from scope_ptz.bench.engine.stored_run import FRAME_HEIGHT_PX, FRAME_WIDTH_PX, StoredRun, sample_name, trace_of
from scope_ptz.bench.engine.traces.frame_comparison import compare_frames
from scope_ptz.bench.engine.traces.verification_results import RunVerification, Status, VerificationResult
from scope_ptz.bench.program_runner import BlankCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import PackError, TraceError, UnknownNameError
from scope_ptz.perception.base import Perception
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.views import RENDERING_VERSION

CONCURRENCY = 2
"""Number of runs that are verified concurrently. Each run renders frames in worker threads."""
MAX_DIFFERENCES_LISTED = 3
"""Maximum number of differences to list per run."""
ReadPicture = Callable[[str], bytes | None]
"""Function that returns the JPEG data of a stored picture by its name in the trace, or None if it was not stored."""


@dataclass(frozen=True, slots=True)
class RunToVerify:
    """A run to verify, with its stored data.

    Attributes:
        entry: The entry that was run.
        epoch: Number of the run of this entry, from 1.
        stored_run: The stored data.
        picture: Function that returns stored pictures; None if the source of the run contains no pictures.
    """

    entry: Entry
    epoch: int
    stored_run: StoredRun
    picture: ReadPicture | None = None

    @property
    def name(self) -> str:
        """Name of the run's sample."""
        return sample_name(self.entry.facts.id, self.epoch)


@dataclass(frozen=True, slots=True)
class VerificationContext:
    """The resources for verification, which the caller provides.

    Attributes:
        open_scene: Opens a scene, or a variation of one, by name.
        make_perception: Creates a perception backend from a name and a seed; returns None if replies cannot be recomputed.
        true_count: Returns the true count for a perception call.
    """

    open_scene: OpenScene
    make_perception: Callable[[str, int | None], Perception | None]
    true_count: TrueCount


async def verify_runs(
    runs: Iterator[RunToVerify], context: VerificationContext, progress: Callable[[int], None] = lambda _: None
) -> VerificationResult:
    """Verify runs, a few at a time.

    Args:
        runs: The runs. They are read one after the other, because their pictures take a lot of memory.
        context: The resources for verification.
        progress: Called after each run with the number of verified runs.
    """
    results: dict[int, RunVerification] = {}
    slots = anyio.Semaphore(CONCURRENCY)

    async def work(number: int, run: RunToVerify) -> None:
        try:
            results[number] = await verify_run(run, context)
            progress(len(results))
        finally:
            slots.release()

    async with anyio.create_task_group() as group:
        for number, run in enumerate(runs):
            await slots.acquire()
            group.start_soon(work, number, run)
    return VerificationResult(tuple(results[number] for number in sorted(results)))


async def verify_run(run: RunToVerify, context: VerificationContext) -> RunVerification:
    """Repeat the calls of a run, and compare the results with its trace and pictures."""
    try:
        trace = trace_of(run.stored_run.trace, Path(run.name))
    except TraceError as error:
        return RunVerification(run.name, "differs", (str(error).rstrip("."),))
    if trace is None:
        return RunVerification(run.name, "not-verifiable", ("there is no trace",))
    perception, reason = _perception(trace, context)
    if reason:
        return RunVerification(run.name, "not-verifiable", (reason,))
    try:
        return await _verify(run, trace, perception, context)
    except (PackError, UnknownNameError) as error:
        return RunVerification(run.name, "not-verifiable", (f"the scene cannot be opened: {str(error).rstrip('.')}",))
    except Exception as error:  # a forged trace can cause any failure
        detail = str(error).rstrip(".") or type(error).__name__
        return RunVerification(run.name, "differs", (f"the calls cannot be repeated: {detail}",))


def _perception(trace: Trace, context: VerificationContext) -> tuple[Perception | None, str]:
    """Return the perception backend for recomputing replies (None for a model), and the reason if the trace cannot be verified."""
    started = trace.started
    if not started.simulated:
        return None, "the run used a camera that is not simulated"
    if started.rendering != RENDERING_VERSION:
        version = "an older version" if started.rendering is None else f"version {started.rendering}"
        return None, f"the run was rendered by {version} of the simulator, and this is version {RENDERING_VERSION}"
    backend = context.make_perception(started.perception, started.labels.seed)
    if backend is not None and started.perception_version != backend.version:
        version = "an older version" if started.perception_version is None else f"version {started.perception_version}"
        return None, f"the run used {version} of ground-truth perception, and this is version {backend.version}"
    return backend, ""


async def _verify(run: RunToVerify, trace: Trace, perception: Perception | None, context: VerificationContext) -> RunVerification:
    entry, stored_run, started = run.entry, run.stored_run, trace.started
    scene = context.open_scene(entry.world)
    clock = SceneClock(entry.time_s)
    with_frames = started.frame is not None and run.picture is not None
    make_camera = SimulatedCamera if with_frames else BlankCamera
    camera = make_camera(scene, clock=clock, width=FRAME_WIDTH_PX, height=FRAME_HEIGHT_PX)
    with clock.hold():
        await camera.go_to_preset(entry.facts.preset)
    store = PictureStore() if with_frames else None
    resimulation = await resimulate(trace, camera, perception, store or NoImages(), snapshots=started.frame is not None)
    differences = [*_preset_viewpoint_differences(stored_run, scene), *resimulation.differences]
    frames = 0
    if store is not None and run.picture is not None:
        await store.encode_pending()
        frame_differences, frames = await _frame_differences(run.picture, trace, resimulation, store.urls)
        differences += frame_differences
    differences += [text async for text in _count_differences(entry, stored_run, trace, context.true_count)]
    status: Status = "differs" if differences else "verified"
    return RunVerification(run.name, status, tuple(differences[:MAX_DIFFERENCES_LISTED]), frames, replies=perception is not None)


def _preset_viewpoint_differences(stored_run: StoredRun, scene: Any) -> Iterator[str]:
    presets = {preset.name: preset.viewpoint for preset in scene.file.presets}
    if (dict(stored_run.presets), stored_run.home) != (presets, presets[scene.file.home_preset]):
        yield "the stored viewpoints of the presets differ from those of the scene"


async def _frame_differences(
    picture: ReadPicture, trace: Trace, resimulation: Resimulation, urls: Mapping[str, str]
) -> tuple[list[str], int]:
    """Return the differences between stored and rendered frames, and the number of compared frames."""
    differences, compared = list[str](), set[str]()
    for where, name, new_name in picture_pairs(trace, resimulation.repeated):
        if name in compared:
            continue
        compared.add(name)
        stored = picture(name)
        if stored is None:
            differences.append(f"the picture {name} {where} is missing")
        elif new_name not in urls:
            differences.append(f"the picture {name} {where} was never taken")
        else:
            difference = await to_thread.run_sync(compare_frames, stored, jpeg_of(urls[new_name]))
            if difference is None:
                differences.append(f"the picture {name} {where} is damaged or has a different size")
            elif not difference.accepted:
                differences.append(f"the picture {name} {where} does not show the view: {difference}")
    return differences, len(compared)


async def _count_differences(entry: Entry, stored_run: StoredRun, trace: Trace, true_count: TrueCount) -> AsyncIterator[str]:
    """Yield the differences between stored and recomputed true counts, which affect the error mode of a failed run."""
    if not stored_run.truths:
        return
    for number, call in enumerate(stored_run.episode(trace).calls):
        for observation in call.observations:
            if observation.kind == "count":
                stored, computed = stored_run.truths.get(str(number)), await true_count(entry.world, observation)
                if stored != computed:
                    yield f"the true count of call {number + 1} was recorded as {stored}, but is {computed}"

"""The asynchronous session, on which the synchronous session is based."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Generator, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar

import anyio

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.records import Called, Decided, Ended, RunLabels, Started
from scope_ptz.agent.store import MemoryImages, RunFolder
from scope_ptz.agent.trace import TraceWriter, trace_of
from scope_ptz.api.building import Parts, build_parts
from scope_ptz.api.function_calling import Arguments, SchemaForm, ToolOutput, run_tool_call, schemas_in_form
from scope_ptz.api.options import SessionOptions
from scope_ptz.api.pictures import ToolCallImages
from scope_ptz.api.run import Event, Run, create_event
from scope_ptz.camera.base import Camera, Frame
from scope_ptz.camera.guard.guarded_camera import GuardedCamera
from scope_ptz.errors import InputError, ScopeError
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import PastTurn, Planner
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.count_objects import CountResult
from scope_ptz.tools.get_presets import PresetsResult
from scope_ptz.tools.query_answer import AnswerResult
from scope_ptz.tools.registry import TOOLS, run_tool
from scope_ptz.tools.results import MoveResult, Result
from scope_ptz.tools.take_image import ImageResult
from scope_ptz.tools.track_object import TrackResult
from scope_ptz.tools.zoom_to_object import ZoomResult

if TYPE_CHECKING:
    from anyio.streams.memory import MemoryObjectSendStream
    from PIL import Image

    from scope_ptz.api.scenes import SceneInfo

EventListener = Callable[[Event], None]
View = Literal["current", "full"]
_R = TypeVar("_R", bound=Result)


class AsyncScope:
    """A session for asynchronous code: a camera, a planner and a perception backend that stay open for several runs.

    ``scope_ptz.open_async`` creates a session. Its methods and their arguments are the same as those of ``Scope``, but methods that
    wait for the camera or a model are coroutines.

    Example:
        >>> import asyncio, scope_ptz
        >>> async def main():
        ...     async with scope_ptz.open_async("highway-works") as scope:
        ...         run = await scope.ask("how many cones are there?")
        ...         return run.outcome
        >>> asyncio.run(main())
        'answered'
    """

    def __init__(self, options: SessionOptions) -> None:
        self._options = options
        self._parts: Parts | None = None
        self._closed = False
        self._cancel_scope: anyio.CancelScope | None = None
        self._finished: anyio.Event | None = None
        self._runs: tuple[Run, ...] = ()
        self._conversation: tuple[PastTurn, ...] = ()
        self._images = ToolCallImages(options.runs_dir)
        self._dispatch_lock = anyio.Lock()

    async def __aenter__(self) -> Self:
        if self._closed:
            raise InputError("This session is closed. Open another one with scope_ptz.open_async().")
        if self._parts is None:
            self._parts = await build_parts(self._options)
        return self

    def __await__(self) -> Generator[Any, None, Self]:
        return self.__aenter__().__await__()

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """Cancel any run or tool call in progress, then close the camera and the connections to models.

        Calling it again has no effect.
        """
        self._closed = True
        self.cancel()
        with anyio.CancelScope(shield=True):
            if self._finished is not None:
                await self._finished.wait()
            parts, self._parts = self._parts, None
            if parts is not None:
                await parts.release()

    @property
    def camera(self) -> Camera:
        """The camera."""
        return self._open_parts().camera

    @property
    def planner(self) -> Planner:
        """The planner."""
        return self._open_parts().planner

    @property
    def perception(self) -> Perception:
        """The perception backend."""
        return self._open_parts().perception

    @property
    def scene(self) -> SceneInfo | None:
        """The scene that provides the ground truth of the camera's frames; None if there is none."""
        scene = self._open_parts().scene
        if scene is None:
            return None
        from scope_ptz.api.scenes import SceneInfo

        return SceneInfo(scene)

    @property
    def runs(self) -> tuple[Run, ...]:
        """All runs of this session in order, including cancelled ones."""
        return self._runs

    async def ask(self, instruction: str) -> Run:
        """Carry out an instruction and return the run. See ``Scope.ask``."""
        return await self.run_with_events(instruction, lambda _: None)

    async def stream(self, instruction: str) -> AsyncIterator[Event]:
        """Carry out an instruction and yield its events as they happen. See ``Scope.stream``."""
        self._require_idle()
        send, receive = anyio.create_memory_object_stream[Event](float("inf"))
        work = asyncio.create_task(self.run_with_events(instruction, partial(_send, send)))
        work.add_done_callback(lambda _: send.close())
        try:
            async for event in receive:
                yield event
            await work
        finally:
            # If the caller stops reading events early, the run is cancelled.
            receive.close()
            work.cancel()
            with anyio.CancelScope(shield=True):
                await asyncio.wait([work])

    def cancel(self) -> None:
        """Cancel the run or tool call in progress, if any. A cancelled run ends with the outcome "cancelled"."""
        if self._cancel_scope is not None:
            self._cancel_scope.cancel()

    def forget(self) -> None:
        """Clear the conversation, so that the next instruction cannot refer to earlier ones. ``runs`` is not cleared."""
        self._conversation = ()

    async def pose(self) -> Pose:
        """Return the camera's pose."""
        return await self._open_parts().camera.pose()

    async def frame(self) -> Frame:
        """Take a frame of the current view."""
        return await self._open_parts().camera.frame()

    async def move(
        self,
        pan_deg: float = 0.0,
        tilt_deg: float = 0.0,
        zoom_factor: float | None = None,
        zoom_percent: float | None = None,
        zoom_limit: Literal["in", "out"] | None = None,
    ) -> MoveResult:
        """Turn and zoom the camera relative to its current pose. A short name for ``adjust_ptz``. See ``Scope.move``."""
        return await self.adjust_ptz(pan_deg, tilt_deg, zoom_factor, zoom_percent, zoom_limit)

    async def move_to(self, pan_deg: float | None = None, tilt_deg: float | None = None, zoom: float | None = None) -> Pose:
        """Move the camera to an absolute pose and return the pose reached. See ``Scope.move_to``."""
        with self._busy():
            camera = self._open_parts().camera
            now = await camera.pose()
            try:
                target = Pose(
                    now.pan_deg if pan_deg is None else pan_deg,
                    now.tilt_deg if tilt_deg is None else tilt_deg,
                    now.zoom if zoom is None else zoom,
                )
            except ValueError as error:
                raise InputError(f"The pose is invalid: {error}.") from error
            return (await camera.move(target)).pose
        raise _cancelled_call()

    async def adjust_ptz(
        self,
        pan_deg: float = 0.0,
        tilt_deg: float = 0.0,
        zoom_factor: float | None = None,
        zoom_percent: float | None = None,
        zoom_limit: Literal["in", "out"] | None = None,
    ) -> MoveResult:
        """Turn and zoom the camera relative to its current pose. See ``Scope.adjust_ptz``."""
        return await self._run_tool(
            MoveResult,
            "adjust_ptz",
            pan_deg=pan_deg,
            tilt_deg=tilt_deg,
            zoom_factor=zoom_factor,
            zoom_percent=zoom_percent,
            zoom_limit=zoom_limit,
        )

    async def go_to_preset(self, name: str) -> MoveResult:
        """Go to a named preset view. See ``Scope.go_to_preset``."""
        return await self._run_tool(MoveResult, "go_to_preset", name=name)

    async def go_home(self) -> MoveResult:
        """Return to the home view."""
        return await self._run_tool(MoveResult, "go_home")

    async def get_presets(self) -> PresetsResult:
        """List the named preset views."""
        return await self._run_tool(PresetsResult, "get_presets")

    async def take_image(self) -> ImageResult:
        """Store a picture of the current view. See ``Scope.take_image``."""
        return await self._run_tool(ImageResult, "take_image")

    async def count_objects(self, description: str, view: View = "current") -> CountResult:
        """Count the objects that match a description. See ``Scope.count_objects``."""
        return await self._run_tool(CountResult, "count_objects", description=description, view=view)

    async def query_answer(self, question: str, view: View = "current") -> AnswerResult:
        """Answer a question about the camera's view. See ``Scope.query_answer``."""
        return await self._run_tool(AnswerResult, "query_answer", question=question, view=view)

    async def zoom_to_object(self, description: str) -> ZoomResult:
        """Find an object in the current view, centre it and zoom in on it. See ``Scope.zoom_to_object``."""
        return await self._run_tool(ZoomResult, "zoom_to_object", description=description)

    async def track_object(self, description: str, duration_s: float = 10.0) -> TrackResult:
        """Keep a moving object in the centre of the view for a given time. See ``Scope.track_object``."""
        return await self._run_tool(TrackResult, "track_object", description=description, duration_s=duration_s)

    def tool_schemas(self, form: SchemaForm = "chat") -> list[dict[str, Any]]:
        """Return the schemas of the tools for a model. See ``Scope.tool_schemas``."""
        return schemas_in_form(form)

    async def dispatch(self, name: str, arguments: Arguments = None) -> ToolOutput:
        """Run a tool call that a model made, and return its outcome for the model. See ``Scope.dispatch``."""
        async with self._dispatch_lock:  # concurrent calls run one after the other
            return await run_tool_call(self._run_tool, self.picture, name, arguments)

    def __getattr__(self, name: str) -> Any:
        """Return a method that calls a registered tool for which this class has no method."""
        if name in TOOLS:
            return partial(self._run_tool, Result, name)
        raise AttributeError(f"A session has no attribute '{name}'.")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *TOOLS})

    async def run_with_events(self, instruction: str, listener: EventListener) -> Run:
        """Carry out an instruction, and pass each event to a listener as it happens.

        Raises:
            InputError: The instruction is empty or too long, the session is closed or busy, or a file cannot be written.
            PackError: The files of a scene are damaged.
            CameraError: The camera failed before the first step.
        """
        parts, options = self._open_parts(), self._options
        self._require_idle()
        if not instruction.strip():
            raise InputError("The instruction is empty. Describe what the camera should do.")
        if isinstance(parts.camera, GuardedCamera):
            parts.camera.record_instruction(instruction)
        recorder = _Recorder(options, instruction, listener)
        labels = RunLabels(perception_note=parts.note, seed=options.seed, home_viewpoint=options.viewpoint)
        agent = Agent(parts.planner, parts.camera, parts.perception, recorder.images, budgets=options.budgets, labels=labels)
        try:
            with recorder, self._busy():
                result = await agent.run(instruction, conversation=self._conversation, listener=recorder)
                self._conversation = (*self._conversation, result.past_turn())
        finally:
            run = recorder.run()
            if run is not None:
                self._runs = (*self._runs, run)
        if run is None:
            raise ScopeError("The run was cancelled before it started.")
        listener(Event("ended", f"{run.outcome}: {run.answer}", run=run))
        return run

    async def _run_tool(self, result_type: type[_R], name: str, /, **arguments: Any) -> _R:
        """Run a tool without the planner."""
        parts = self._open_parts()
        with self._busy():
            context = ToolContext(parts.camera, parts.perception, self._images)
            result = await run_tool(context, name, arguments)
            assert isinstance(result, result_type), f"{name} returned a {type(result).__name__}"  # noqa: S101 - a bug in the tool
            return result
        raise _cancelled_call()

    def picture(self, name: str) -> Image.Image:
        """Open a picture that ``take_image`` stored outside a run. See ``Scope.picture``."""
        return self._images.picture(name)

    @contextmanager
    def _busy(self) -> Iterator[None]:
        """Mark the session as busy during a block. If ``cancel`` is called, the block ends without an exception."""
        self._require_idle()
        self._finished = anyio.Event()
        try:
            with anyio.CancelScope() as self._cancel_scope:
                yield
        finally:
            self._cancel_scope = None
            self._finished.set()

    def _open_parts(self) -> Parts:
        """Return the parts of the session. Raises ``InputError`` if the session is not open."""
        if self._parts is None or self._closed:
            state = "is closed" if self._closed else "is not open yet: use `async with` or `await`"
            raise InputError(f"This session {state}. Open one with scope_ptz.open() or scope_ptz.open_async().")
        return self._parts

    def _require_idle(self) -> None:
        """Raise ``InputError`` if the session is not open, or if a run or tool call is in progress."""
        self._open_parts()
        if self._cancel_scope is not None:
            raise InputError(
                "A run or tool call is in progress in this session. Wait for it, call cancel(), or open another session."
            )


def _send(stream: MemoryObjectSendStream[Event], event: Event) -> None:
    """Send an event to the caller unless the caller has stopped reading events."""
    with suppress(anyio.BrokenResourceError):
        stream.send_nowait(event)


def _cancelled_call() -> ScopeError:
    return ScopeError("The call was cancelled.")


class _Recorder:
    """Collects the records of a run, writes the trace if runs are stored in a folder, and passes events to the listener."""

    def __init__(self, options: SessionOptions, instruction: str, listener: EventListener) -> None:
        folder = options.runs_dir
        self.images: MemoryImages | RunFolder = MemoryImages() if folder is None else RunFolder.create(folder, instruction)
        self._listener = listener
        self._records: list[Started | Decided | Called | Ended] = []
        self._stack = ExitStack()
        self._write: Callable[[Started | Decided | Called | Ended], None] = lambda _: None

    def __enter__(self) -> Self:
        if isinstance(self.images, RunFolder):
            self._stack.callback(self.images.discard_if_not_started)
            self._write = self._stack.enter_context(TraceWriter(self.images.trace))
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def __call__(self, record: Started | Decided | Called | Ended) -> None:
        self._write(record)
        self._records.append(record)
        if not isinstance(record, Ended):
            self._listener(create_event(record))

    def run(self) -> Run | None:
        """Return the finished run; None if the run did not start, or its end could not be recorded."""
        if not self._records or not isinstance(ended := self._records[-1], Ended):
            return None
        if isinstance(self.images, RunFolder):
            return Run(trace_of(self._records, self.images.path), ended)
        return Run(trace_of(self._records, Path()), ended, self.images.files)

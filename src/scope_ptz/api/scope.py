"""The synchronous session."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterator
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, Self, TypeVar

from scope_ptz.api.async_scope import View
from scope_ptz.api.event_loop import EventLoopThread
from scope_ptz.api.function_calling import Arguments, SchemaForm, ToolOutput
from scope_ptz.api.options import SessionOptions
from scope_ptz.api.run import Event, Run
from scope_ptz.api.sessions import new_session
from scope_ptz.camera.base import Camera, Frame
from scope_ptz.errors import InputError
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Perception
from scope_ptz.planner.base import Planner
from scope_ptz.tools.count_objects import CountResult
from scope_ptz.tools.get_presets import PresetsResult
from scope_ptz.tools.query_answer import AnswerResult
from scope_ptz.tools.registry import TOOLS
from scope_ptz.tools.results import MoveResult, Result
from scope_ptz.tools.take_image import ImageResult
from scope_ptz.tools.track_object import TrackResult
from scope_ptz.tools.zoom_to_object import ZoomResult

if TYPE_CHECKING:
    from PIL import Image

    from scope_ptz.api.scenes import SceneInfo

_T = TypeVar("_T")


class Scope:
    """A session: a camera, a planner and a perception backend that stay open for several runs. ``scope_ptz.open`` creates one.

    ``ask`` and ``stream`` pass an instruction to the planner, together with the earlier instructions of the session and their
    answers. The nine tools are also methods of the session. They move the camera and call perception without the planner.

    A session works in scripts and in notebooks. Ctrl-C cancels the run in progress, and its trace is still complete. Only one run
    or tool call can be in progress at a time; open several sessions to work with several cameras.

    Example:
        >>> import scope_ptz
        >>> with scope_ptz.open("highway-works") as scope:
        ...     run = scope.ask("pan right 20 degrees and count the workers")
        ...     moved = scope.move(pan_deg=-20)
        ...     cones = scope.count_objects("cones", view="full")
        >>> [call.name for call in run.calls]
        ['adjust_ptz', 'count_objects']
        >>> moved.pose.pan_deg, cones.complete
        (8.0, False)
    """

    def __init__(self, options: SessionOptions) -> None:
        self._session = new_session(options)
        self._loop = EventLoopThread(self._session.close)
        self._closed = False
        try:
            self._loop.call(self._session.__aenter__)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        self._require_open()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Cancel any run or tool call in progress, then close the camera and the connections to models.

        Objects that you passed to ``scope_ptz.open`` stay open. Calling ``close`` again has no effect.
        """
        if not self._closed:
            self._closed = True
            self._loop.stop()

    def ask(self, instruction: str) -> Run:
        """Carry out an instruction.

        If the planner or the camera fails during the run, no exception is raised: ``Run.outcome`` reports the failure.

        Args:
            instruction: What the camera should do, in plain language. It may refer to earlier instructions of the session.

        Returns:
            The finished run.

        Raises:
            InputError: The instruction is empty or too long, the session is closed or busy, or a file cannot be written.
            PackError: The files of a scene are damaged.
            CameraError: The camera failed before the first step.
            KeyboardInterrupt: Ctrl-C was pressed. The cancelled run is the last one in ``runs``.

        Example:
            >>> import scope_ptz
            >>> with scope_ptz.open("highway-works") as scope:
            ...     print(scope.ask("zoom in 2x").outcome)
            answered
        """
        return self._call(partial(self._session.ask, instruction))

    def stream(self, instruction: str) -> Iterator[Event]:
        """Carry out an instruction and yield its events as they happen.

        The run starts when the first event is requested. Leaving the loop early cancels the run.

        Args:
            instruction: What the camera should do, in plain language. It may refer to earlier instructions of the session.

        Yields:
            The events of the run. The last one contains the finished run in ``event.run``.

        Raises:
            InputError: The instruction is empty or too long, the session is closed or busy, or a file cannot be written.
            PackError: The files of a scene are damaged.
            CameraError: The camera failed before the first step.

        Example:
            >>> import scope_ptz
            >>> with scope_ptz.open("highway-works") as scope:
            ...     for event in scope.stream("count all workers"):
            ...         if event.call is not None:
            ...             print(event.call.name)
            count_objects
        """
        self._require_open()
        yield from self._loop.iterate(partial(self._session.run_with_events, instruction))

    def cancel(self) -> None:
        """Cancel the run or tool call in progress, if any. Call it from another thread.

        A cancelled run ends with the outcome "cancelled", and ``ask`` returns it. A cancelled tool call raises ``ScopeError``.
        """
        if not self._closed:
            with suppress(RuntimeError):  # the session was closed at the same time
                self._loop.call_function(self._session.cancel)

    def forget(self) -> None:
        """Clear the conversation, so that the next instruction cannot refer to earlier ones. ``runs`` is not cleared."""
        self._session.forget()

    @property
    def runs(self) -> tuple[Run, ...]:
        """All runs of this session in order, including cancelled ones."""
        return self._session.runs

    @property
    def camera(self) -> Camera:
        """The camera."""
        return self._session.camera

    @property
    def planner(self) -> Planner:
        """The planner."""
        return self._session.planner

    @property
    def perception(self) -> Perception:
        """The perception backend."""
        return self._session.perception

    @property
    def scene(self) -> SceneInfo | None:
        """The scene that provides the ground truth of the camera's frames; None if there is none."""
        return self._session.scene

    def pose(self) -> Pose:
        """Return the camera's pose.

        Returns:
            The pose, with ``pan_deg``, ``tilt_deg`` and ``zoom``.

        Raises:
            InputError: The session is closed.
            CameraError: The camera failed.
        """
        return self._call(self._session.pose)

    def frame(self) -> Frame:
        """Take a frame of the current view.

        Returns:
            The frame. ``frame.image`` is an ``(H, W, 3)`` uint8 RGB array; a notebook displays the frame as a picture.

        Raises:
            InputError: The session is closed.
            CameraError: The camera failed.
        """
        return self._call(self._session.frame)

    def picture(self, name: str) -> Image.Image:
        """Open a picture that ``take_image`` stored.

        Args:
            name: Name of the picture, which is the field ``file`` in the result of ``take_image``.

        Returns:
            The picture.

        Raises:
            TraceError: There is no such picture.
        """
        return self._session.picture(name)

    def move(
        self,
        pan_deg: float = 0.0,
        tilt_deg: float = 0.0,
        zoom_factor: float | None = None,
        zoom_percent: float | None = None,
        zoom_limit: Literal["in", "out"] | None = None,
    ) -> MoveResult:
        """Turn and zoom the camera relative to its current pose.

        This is a short name for ``adjust_ptz``, with the same arguments, result and errors.

        Example:
            >>> import scope_ptz
            >>> with scope_ptz.open("highway-works") as scope:
            ...     print(scope.move(zoom_factor=2.0).pose.zoom)
            2.0
        """
        return self.adjust_ptz(pan_deg, tilt_deg, zoom_factor, zoom_percent, zoom_limit)

    def move_to(self, pan_deg: float | None = None, tilt_deg: float | None = None, zoom: float | None = None) -> Pose:
        """Move the camera to an absolute pose.

        Args:
            pan_deg: Pan in degrees; positive is to the right of the camera's zero direction. Unchanged by default.
            tilt_deg: Tilt in degrees; 0 is the horizon, and positive is up. Unchanged by default.
            zoom: Magnification; 1 is the widest view. Unchanged by default.

        Returns:
            The pose reached, which is the nearest pose within the camera's limits.

        Raises:
            InputError: A number is not finite, the zoom is not positive, or the session is closed or busy.
            CameraError: The camera failed.
            ScopeError: The call was cancelled.
        """
        return self._call(partial(self._session.move_to, pan_deg, tilt_deg, zoom))

    def adjust_ptz(
        self,
        pan_deg: float = 0.0,
        tilt_deg: float = 0.0,
        zoom_factor: float | None = None,
        zoom_percent: float | None = None,
        zoom_limit: Literal["in", "out"] | None = None,
    ) -> MoveResult:
        """Turn and zoom the camera relative to its current pose.

        Args:
            pan_deg: Degrees to turn right; negative turns left.
            tilt_deg: Degrees to turn up; negative turns down.
            zoom_factor: Factor by which the magnification is multiplied; 2.0 zooms in to twice the magnification.
            zoom_percent: Change of the magnification in percent; 50 multiplies it by 1.5.
            zoom_limit: "in" for the highest magnification, "out" for the lowest.

        Returns:
            The result: ``pose`` is the pose reached, and ``clamped`` lists the axes on which a limit stopped the camera.

        Raises:
            ToolCallError: The arguments are invalid, for example more than one zoom argument.
            InputError: The session is closed or busy.
            CameraError: The camera failed.
            ScopeError: The call was cancelled.

        Example:
            >>> import scope_ptz
            >>> with scope_ptz.open("highway-works") as scope:
            ...     result = scope.adjust_ptz(pan_deg=-20, zoom_percent=50)
            >>> result.pose.zoom, result.clamped
            (1.5, ())
        """
        return self._call(partial(self._session.adjust_ptz, pan_deg, tilt_deg, zoom_factor, zoom_percent, zoom_limit))

    def go_to_preset(self, name: str) -> MoveResult:
        """Go to a named preset view.

        Args:
            name: One of the names that ``get_presets`` lists.

        Returns:
            The result, with the ``pose`` reached and the name of the ``preset``.

        Raises:
            UnknownNameError: There is no such preset.
            InputError: The session is closed or busy.
            CameraError: The camera failed.
        """
        return self._call(partial(self._session.go_to_preset, name))

    def go_home(self) -> MoveResult:
        """Return to the home view.

        Returns:
            The result, with the ``pose`` reached.

        Raises:
            InputError: The session is closed or busy.
            CameraError: The camera failed.
        """
        return self._call(self._session.go_home)

    def get_presets(self) -> PresetsResult:
        """List the named preset views.

        Returns:
            The result, with the names in ``presets``.

        Raises:
            InputError: The session is closed or busy.
            CameraError: The camera failed.
        """
        return self._call(self._session.get_presets)

    def take_image(self) -> ImageResult:
        """Store a picture of the current view.

        Returns:
            The result, with the name of the picture in ``file``. ``picture(name)`` opens it.

        Raises:
            InputError: The session is closed or busy, or the file cannot be written.
            CameraError: The camera failed.
        """
        return self._call(self._session.take_image)

    def count_objects(self, description: str, view: View = "current") -> CountResult:
        """Count the objects that match a description.

        Args:
            description: What to count, for example "traffic cones".
            view: "current" for this view, "full" to sweep everything around the camera.

        Returns:
            The result: the ``count``, and the ``boxes`` of the objects. ``complete`` is False if the count is a lower bound.

        Raises:
            PerceptionError: Perception failed.
            ToolCallError: The arguments are invalid.
            InputError: The session is closed or busy.
            CameraError: The camera failed.

        Example:
            >>> import scope_ptz
            >>> with scope_ptz.open("highway-works") as scope:
            ...     print(scope.count_objects("cones").count)
            7
        """
        return self._call(partial(self._session.count_objects, description, view))

    def query_answer(self, question: str, view: View = "current") -> AnswerResult:
        """Answer a question about the camera's view, for example about existence, colour, text, position or state.

        Args:
            question: The question in plain language.
            view: "current" for this view, "full" to sweep everything around the camera.

        Returns:
            The result, with the ``answer``. ``known`` is False if the answer cannot be determined from the view.

        Raises:
            PerceptionError: Perception failed.
            ToolCallError: The arguments are invalid.
            InputError: The session is closed or busy.
            CameraError: The camera failed.
        """
        return self._call(partial(self._session.query_answer, question, view))

    def zoom_to_object(self, description: str) -> ZoomResult:
        """Find an object in the current view, centre it and zoom in on it.

        Args:
            description: What to zoom in on, for example "the white van".

        Returns:
            The result: ``found`` states whether the object was found, and ``fill`` is the fraction of the frame that it fills.

        Raises:
            PerceptionError: Perception failed.
            ToolCallError: The arguments are invalid.
            InputError: The session is closed or busy.
            CameraError: The camera failed.
        """
        return self._call(partial(self._session.zoom_to_object, description))

    def track_object(self, description: str, duration_s: float = 10.0) -> TrackResult:
        """Keep a moving object in the centre of the view for a given time.

        Args:
            description: What to track, for example "the white van".
            duration_s: Duration in seconds of scene time, at most 600.

        Returns:
            The result: ``path`` is the camera's path, and ``held_share`` is the fraction of the time during which the object was
            seen.

        Raises:
            PerceptionError: Perception failed.
            ToolCallError: The arguments are invalid.
            InputError: The session is closed or busy.
            CameraError: The camera failed.
        """
        return self._call(partial(self._session.track_object, description, duration_s))

    def tool_schemas(self, form: SchemaForm = "chat") -> list[dict[str, Any]]:
        """Return the tool schemas, to offer the tools to a model.

        Except for "mcp", the schemas do not contain keywords that some model servers reject, such as patterns. ``dispatch`` checks
        every call.

        Args:
            form: The API: "chat" for OpenAI chat completions, "responses" for OpenAI responses, "anthropic" for Anthropic
                messages, "mcp" for the Model Context Protocol.

        Returns:
            One schema per tool.

        Raises:
            InputError: The form is unknown.

        Example:
            >>> import scope_ptz
            >>> with scope_ptz.open("highway-works") as scope:
            ...     print(scope.tool_schemas("responses")[2]["name"])
            go_home
        """
        return self._session.tool_schemas(form)

    def dispatch(self, name: str, arguments: Arguments = None) -> ToolOutput:
        """Run a tool call that a model made, and return its outcome for the model.

        A call that cannot be carried out raises no exception: the outcome tells the model the reason, such as an unknown tool,
        arguments that are not valid JSON, an unknown preset, or a failure of perception. Concurrent calls, which some agent
        frameworks make, run one after the other.

        Args:
            name: Name of the tool, as the model sent it.
            arguments: The arguments as a dictionary, or as the JSON text that the model sent.

        Returns:
            The outcome: ``text`` for the model, ``ok``, and either the ``result`` as an object or the ``error``. ``pictures``
            contains the picture that ``take_image`` took, with its ``caption`` and ``data_url``.

        Raises:
            InputError: The session is closed or busy, or the picture cannot be written.
            CameraError: The camera failed.
            ScopeError: The call was cancelled.

        Example:
            >>> import scope_ptz
            >>> with scope_ptz.open("highway-works") as scope:
            ...     output = scope.dispatch("count_objects", '{"description": "cones"}')
            ...     print(output.result.count)
            ...     print(scope.dispatch("go_to_preset", {"name": "nowhere"}).ok)
            7
            False
        """
        return self._call(partial(self._session.dispatch, name, arguments))

    def __getattr__(self, name: str) -> Any:
        """Return a method that calls a registered tool for which this class has no method."""
        if name in TOOLS:

            def run_tool(**arguments: Any) -> Result:
                result: Result = self._call(partial(getattr(self._session, name), **arguments))
                return result

            return run_tool
        raise AttributeError(f"A session has no attribute '{name}'.")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *TOOLS})

    def _require_open(self) -> None:
        """Raise ``InputError`` if the session is closed."""
        if self._closed:
            raise InputError("This session is closed. Open another one with scope_ptz.open().")

    def _call(self, work: Callable[[], Awaitable[_T]]) -> _T:
        self._require_open()
        return self._loop.call(work)

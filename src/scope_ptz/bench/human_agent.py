"""A planner and a perception backend for human baselines: a person types commands and describes pictures."""

from __future__ import annotations

import json
import shlex
import time
from collections.abc import Callable
from typing import Any, TypeVar

from anyio import to_thread

from scope_ptz.bench.human_viewer import Viewer
from scope_ptz.camera.base import Camera, Frame
from scope_ptz.errors import InputError, PerceptionError
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Point, Points
from scope_ptz.planner.base import CallTools, Decision, Finish, Planner, State, ToolCall

HELP = """  pan 20  pan -20  tilt -5  zoom 2  zoom in  zoom out   turn and zoom; several of these on one line are one move
  preset NAME   home   presets   picture                go to a preset or home, list presets, take a picture
  count WHAT    count all WHAT                          count in the current view, or in the full scene
  ask QUESTION  ask all QUESTION                        ask about the current view, or about the full scene
  zoomto WHAT   track WHAT SECONDS                      zoom in on something, track something
  answer TEXT   question TEXT   refuse TEXT             end the task with an answer, a clarifying question, or a refusal
  call TOOL {"argument": value}                         call a tool with JSON arguments
  skip          quit                                    leave this task for later; end the session"""

Ask = Callable[[str], str]
"""Function that shows a prompt to the person and returns the typed line. Raises ``EOFError`` at the end of the input."""
T = TypeVar("T")
_FINAL_REPLIES = {"answer": "answered", "question": "clarification", "refuse": "refused"}
"""The outcomes recorded by the commands that end a task."""


class TaskLeftError(Exception):
    """The person left the task unfinished. If ``ends_session`` is true, the person also ended the session."""

    def __init__(self, *, ends_session: bool) -> None:
        super().__init__()
        self.ends_session = ends_session


def parse(line: str) -> ToolCall | Finish | None:
    """Parse a typed line as a tool call or a final reply. Return None if the line is a request for help.

    Raises:
        TaskLeftError: The line is ``skip`` or ``quit``.
        InputError: The line is not a valid command.
    """
    verb, _, rest = line.strip().partition(" ")
    verb, rest = verb.lower(), rest.strip()
    if verb in _FINAL_REPLIES:
        if not rest:
            raise InputError(f"'{verb}' must be followed by text.")
        return Finish(kind=_FINAL_REPLIES[verb], text=rest)  # type: ignore[arg-type]
    if verb in ("skip", "quit"):
        raise TaskLeftError(ends_session=verb == "quit")
    if verb in ("help", "?", ""):
        return None
    name, arguments = _tool_call(verb, rest)
    return ToolCall(id="", name=name, arguments=arguments)


def _tool_call(verb: str, rest: str) -> tuple[str, dict[str, Any]]:
    """Return the tool name and arguments for a command."""
    without_arguments = {"home": "go_home", "presets": "get_presets", "picture": "take_image"}
    if verb in without_arguments and not rest:
        return without_arguments[verb], {}
    if verb in ("pan", "tilt", "zoom"):
        return "adjust_ptz", _turn_arguments(f"{verb} {rest}".split())
    if verb == "preset" and rest:
        return "go_to_preset", {"name": rest}
    if verb in ("count", "ask") and rest:
        full = rest.lower().startswith("all ")
        text = rest[4:].strip() if full else rest
        key = "description" if verb == "count" else "question"
        return ("count_objects" if verb == "count" else "query_answer"), {key: text, "view": "full" if full else "current"}
    if verb == "zoomto" and rest:
        return "zoom_to_object", {"description": rest}
    if verb == "track":
        description, _, seconds = rest.rpartition(" ")
        return "track_object", {"description": description.strip(), "duration_s": _number(seconds)}
    if verb == "call":
        name, _, arguments = rest.partition(" ")
        return name, _json_object(arguments or "{}")
    raise InputError(f"'{verb}' is not a command, or its argument is missing. Type help for a list of commands.")


def _turn_arguments(words: list[str]) -> dict[str, Any]:
    """Parse a command such as ``pan 20 tilt -5 zoom 2`` as arguments for ``adjust_ptz``."""
    if len(words) % 2:
        raise InputError("A value is missing. Examples: pan 20, tilt -5, zoom 2, zoom in.")
    arguments: dict[str, Any] = {}
    for axis, amount in zip(words[::2], words[1::2], strict=True):
        if axis == "zoom" and amount in ("in", "out"):
            arguments["zoom_limit"] = amount
        elif axis in ("pan", "tilt", "zoom"):
            arguments["zoom_factor" if axis == "zoom" else f"{axis}_deg"] = _number(amount)
        else:
            raise InputError(f"Each value must follow pan, tilt or zoom; got '{axis}'.")
    return arguments


def _number(text: str) -> float:
    try:
        return float(text.rstrip("°sx%"))
    except ValueError as error:
        raise InputError(f"A number is required; got '{text}'.") from error


def _json_object(text: str) -> dict[str, Any]:
    try:
        content = json.loads(text)
    except ValueError as error:
        raise InputError(f"{shlex.quote(text)} is not valid JSON: {error}.") from error
    if not isinstance(content, dict):
        raise InputError("The arguments of a call must be a JSON object.")
    return content


class HumanPlanner(Planner):
    """A planner that shows the view and the latest results to a person, and returns the calls that the person types.

    Attributes:
        exit_error: The error that states how the person left the task; None if the person finished it.
    """

    sees = True

    def __init__(
        self, name: str, camera: Camera, viewer: Viewer, perception: HumanPerception, ask: Ask, tell: Callable[[str], None]
    ) -> None:
        self.name, self._camera, self._viewer, self._perception, self._ask, self._tell = name, camera, viewer, perception, ask, tell
        self.exit_error: TaskLeftError | None = None

    async def step(self, state: State) -> Decision:
        for outcome in state.history[-1].outcomes if state.history else ():
            self._tell(f"  {outcome.error or (outcome.result or {}).get('message', 'done')}")
        frame = await self._camera.frame()
        pose = frame.pose.as_dict()
        pose_text = f"pan {pose['pan_deg']:g}°, tilt {pose['tilt_deg']:g}°, zoom {pose['zoom']:g}x"
        self._tell(f"  view ({pose_text}): {self._viewer.show(frame)}")
        while True:
            try:
                command = parse(await to_thread.run_sync(self._ask, "› "))
            except InputError as error:
                self._tell(f"  {error}")
                continue
            except (TaskLeftError, EOFError) as error:
                self.exit_error = error if isinstance(error, TaskLeftError) else TaskLeftError(ends_session=True)
                return Finish(kind="refused", text="left")
            if isinstance(command, Finish):
                return command
            if command is None:
                self._tell(HELP)
                continue
            self._perception.is_counting = command.name == "count_objects"
            return CallTools(calls=(command.model_copy(update={"id": f"call-{len(state.history) + 1}"}),))


class HumanPerception(Perception):
    """A perception backend that asks a person.

    Attributes:
        is_counting: Whether the next detection is for counting. If so, the person enters a number instead of a box.
    """

    def __init__(self, name: str, viewer: Viewer, ask: Ask, tell: Callable[[str], None]) -> None:
        self.name, self._viewer, self._ask, self._tell = name, viewer, ask, tell
        self.is_counting = False
        self._last_box = ""

    async def caption(self, frame: Frame) -> Caption:
        start_s = time.perf_counter()
        text = await self._answer(frame, "What does the picture show?")
        return Caption(text=text, source=self.name, raw=text, latency_s=time.perf_counter() - start_s)

    async def query(self, frame: Frame, question: str) -> Answer:
        start_s = time.perf_counter()
        text = await self._answer(frame, f"{question} (? if you cannot tell)")
        known = text != "?"
        answer = text if known else "I cannot tell."
        return Answer(text=answer, known=known, source=self.name, raw=text, latency_s=time.perf_counter() - start_s)

    async def detect(self, frame: Frame, description: str) -> Detections:
        start_s = time.perf_counter()
        if self.is_counting:
            number = await self._ask_until_valid(frame, f"How many: {description}?", _whole_number)
            boxes = (Box(x_min=0, y_min=0, x_max=1, y_max=1, label="counted, place not asked"),) * number
        else:
            boxes = await self._ask_box(frame, description)
        return Detections(boxes=boxes, source=self.name, raw=str(len(boxes)), latency_s=time.perf_counter() - start_s)

    async def point(self, frame: Frame, description: str) -> Points:
        boxes = (await self.detect(frame, description)).boxes
        return Points(points=tuple(Point(x=b.centre[0], y=b.centre[1]) for b in boxes), source=self.name)

    async def _ask_box(self, frame: Frame, description: str) -> tuple[Box, ...]:
        question = f"Where is: {description}? left top right bottom, in % of the picture; 'none'; Enter: same as before"
        box = await self._ask_until_valid(frame, question, self._parse_box, grid=True)
        return () if box is None else (box,)

    def _parse_box(self, text: str) -> Box | None:
        text = text or self._last_box
        self._last_box = text
        if text.lower() == "none":
            return None
        sides = [_number(part) / 100 for part in text.replace(",", " ").split()]
        if len(sides) != 4 or not (0 <= sides[0] < sides[2] <= 1 and 0 <= sides[1] < sides[3] <= 1):
            raise InputError("Enter four numbers from 0 to 100 (left, top, right, bottom), or 'none'.")
        return Box(x_min=sides[0], y_min=sides[1], x_max=sides[2], y_max=sides[3])

    async def _answer(self, frame: Frame, question: str) -> str:
        def not_empty(text: str) -> str:
            if not text:
                raise InputError("Type what you see.")
            return text

        return await self._ask_until_valid(frame, question, not_empty)

    async def _ask_until_valid(self, frame: Frame, question: str, parse: Callable[[str], T], *, grid: bool = False) -> T:
        """Show a frame and ask a question until the reply can be parsed."""
        self._tell(f"  picture: {self._viewer.show(frame, grid=grid)}")
        while True:
            try:
                return parse((await to_thread.run_sync(self._ask, f"  {question} ")).strip())
            except InputError as error:
                self._tell(f"  {error}")
            except EOFError as error:
                raise PerceptionError("The input ended before the person answered.") from error


def _whole_number(text: str) -> int:
    if not text.isdecimal() or int(text) > 999:
        raise InputError("Enter a whole number below 1000 in digits.")
    return int(text)

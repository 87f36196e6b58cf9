"""A session with a camera, planner and perception backend on a server."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import aclosing
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Self, TypeVar

import anyio
from pydantic import ValidationError

from scope_ptz.agent.records import RECORD, Ended
from scope_ptz.agent.trace import Trace, picture_names, trace_of
from scope_ptz.api.async_scope import AsyncScope, EventListener
from scope_ptz.api.building import Parts
from scope_ptz.api.options import ModelServerOptions, SessionOptions
from scope_ptz.api.remote.camera import RemoteCamera
from scope_ptz.api.remote.connection import Connection, RemoteNameError
from scope_ptz.api.run import Event, Run, create_event
from scope_ptz.camera.guard.guarded_camera import KeepOutError
from scope_ptz.errors import CameraError, InputError, PerceptionError, PlannerError, ScopeError, ToolCallError
from scope_ptz.perception.no_perception import NoPerception
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.tools.registry import TOOLS
from scope_ptz.tools.results import Result

if TYPE_CHECKING:
    from PIL import Image

_R = TypeVar("_R", bound=Result)
_ERRORS_BY_FAULT: Mapping[str, type[ScopeError]] = {"bad_call": ToolCallError, "perception": PerceptionError}


class RemoteSession(AsyncScope):
    """A session with a camera on a ``scope serve`` server: ``scope_ptz.open("http://host:8000/yard-gate")``.

    The session behaves like a local one, but runs are stored on the server, and their pictures are downloaded on first use.
    """

    def __init__(self, options: SessionOptions) -> None:
        super().__init__(options)
        _check_options(options)
        self._connection = Connection(str(options.camera))
        self._conversation_id: str | None = None

    async def __aenter__(self) -> Self:
        if self._closed:
            raise InputError("This session is closed. Open another one with scope_ptz.open_async().")
        if self._parts is None:
            try:
                self._parts = await self._build()
            except BaseException:
                await self._connection.close()
                raise
        return self

    async def _build(self) -> Parts:
        pairs = await self._connection.request("GET", "/pairs")
        pair = self._options.served.pair or pairs[0]
        if pair not in pairs:
            raise RemoteNameError(f"{self._connection.server} has no pair '{pair}'. It has: {', '.join(pairs)}.")
        camera = await RemoteCamera.open(self._connection)
        if self._options.preset is not None:
            await camera.go_to_preset(self._options.preset)
        planner, _, perception = pair.partition("+")
        return Parts(camera, _RemotePlanner(planner), _RemotePerception(perception or planner), None, "", self._release)

    async def _release(self) -> None:
        try:
            await self._connection.request("DELETE", "~/control")
        except ScopeError:
            pass  # the session can be closed even if the server does not answer
        finally:
            await self._connection.close()

    def forget(self) -> None:
        super().forget()
        self._conversation_id = None

    async def run_with_events(self, instruction: str, listener: EventListener) -> Run:
        self._open_parts()
        self._require_idle()
        if not instruction.strip():
            raise InputError("The instruction is empty. Describe what the camera should do.")
        connection, records, run_id = self._connection, list[Any](), ""
        try:
            with self._busy():
                try:
                    with anyio.CancelScope(shield=True):  # a run whose id is unknown could not be cancelled on the server
                        run_id = await self._start(instruction)
                    await self._follow(run_id, records, listener)
                except anyio.get_cancelled_exc_class():
                    if run_id:
                        with anyio.CancelScope(shield=True):
                            await connection.request("POST", f"/runs/{run_id}/cancel")
                            await self._follow(run_id, records, listener)
                    raise
        finally:
            run = _run(connection, run_id, records)
            if run is not None:
                self._runs = (*self._runs, run)
        if run is None:
            raise ScopeError("The run was cancelled before it began.")
        listener(Event("ended", f"{run.outcome}: {run.answer}", run=run))
        return run

    async def _start(self, instruction: str) -> str:
        connection, pair = self._connection, self._options.served.pair
        if self._conversation_id is None:
            started = await connection.request("POST", "/conversations", {"camera": connection.camera, "pair": pair})
            self._conversation_id = started["id"]
        body = {"camera": connection.camera, "instruction": instruction, "conversation": self._conversation_id, "pair": pair}
        return str((await connection.request("POST", "/runs", body, no_timeout=True))["id"])

    async def _follow(self, run_id: str, records: list[Any], listener: EventListener) -> None:
        """Append the records of a run to ``records`` until the run ends. Records that are already in the list are skipped."""
        number = 0
        async with aclosing(self._connection.events(run_id)) as events:  # type: ignore[type-var] # it is a generator
            async for data in events:
                number += 1
                if number <= len(records):
                    continue
                try:
                    record = RECORD.validate_json(data)
                except ValidationError as error:
                    raise CameraError(
                        "The server reports a step in an unknown format. Use the same version of scope-ptz on both sides."
                    ) from error
                records.append(record)
                if not isinstance(record, Ended):
                    listener(create_event(record))

    async def _run_tool(self, result_type: type[_R], name: str, /, **arguments: Any) -> _R:
        self._open_parts()
        call_arguments = {key: value for key, value in arguments.items() if value is not None}
        TOOLS.parse_call(name, call_arguments)  # invalid arguments raise the same error as in a local session
        with self._busy():
            try:
                reply = await self._connection.request("POST", f"~/tools/{name}{self._query()}", call_arguments, no_timeout=True)
            except anyio.get_cancelled_exc_class():
                with anyio.CancelScope(shield=True):
                    await self._connection.request("POST", "~/stop")
                raise
            if reply["error"] is not None:
                if reply["fault"] == "bad_call" and name == "go_to_preset":
                    raise RemoteNameError(reply["error"])
                kept_out = reply.get("code") == "kept_out"  # servers before 0.2.0 send no code
                raise (KeepOutError if kept_out else _ERRORS_BY_FAULT.get(str(reply["fault"]), CameraError))(reply["error"])
            result = TOOLS[name].result_type().model_validate(reply["result"])
            assert isinstance(result, result_type), f"{name} returned a {type(result).__name__}"  # noqa: S101 - a bug in the tool
            if (file := getattr(result, "file", None)) is not None:
                # The server stores each call as a separate run, so picture names are unique only in combination with the run id.
                result = result.model_copy(update={"file": f"{reply['run']}/{file}"})
            return result
        raise ScopeError("The call was cancelled.")

    def _query(self) -> str:
        from urllib.parse import quote

        return f"?pair={quote(self._options.served.pair)}" if self._options.served.pair else ""

    def picture(self, name: str) -> Image.Image:
        from PIL import Image

        run_id, _, file = name.partition("/")
        return Image.open(BytesIO(self._connection.picture_sync(f"/runs/{run_id}/pictures/{file}")))


class _RemotePlanner(Planner):
    """A planner on a server. It cannot be called locally."""

    def __init__(self, name: str) -> None:
        self.name = name

    async def step(self, state: State) -> Decision:  # noqa: ARG002 - the contract's signature
        raise PlannerError("This planner runs on the server. Use the session's ask().")


class _RemotePerception(NoPerception):
    """A perception backend on a server. It cannot be called locally."""

    def __init__(self, name: str) -> None:
        super().__init__("")
        self.name = name

    def _raise_error(self) -> NoReturn:
        raise PerceptionError("Perception runs on the server. Use the session's methods.")


class _RemotePictures(Mapping[str, bytes]):
    """The pictures of a run on a server, which are downloaded on first use."""

    def __init__(self, connection: Connection, run_id: str, trace: Trace) -> None:
        self._names = tuple(picture_names(trace))
        self._fetch = partial(_fetch, connection, run_id)
        self._cache: dict[str, bytes] = {}

    def __getitem__(self, name: str) -> bytes:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._cache:
            self._cache[name] = self._fetch(name)
        return self._cache[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _fetch(connection: Connection, run_id: str, name: str) -> bytes:
    return connection.picture_sync(f"/runs/{run_id}/pictures/{name}")


def _run(connection: Connection, run_id: str, records: list[Any]) -> Run | None:
    if not records or not isinstance(ended := records[-1], Ended):
        return None
    trace = trace_of(records, Path())
    return Run(trace, ended, _RemotePictures(connection, run_id, trace))


def _check_options(options: SessionOptions) -> None:
    """Raise ``InputError`` for options that only the server can set."""
    if options.dry_run:
        raise InputError("dry_run= cannot be used with a camera on a server. Remove the argument.")
    default, models = SessionOptions(options.camera), options.served
    names = ("planner", "perception", "viewpoint", "time_s", "seed", "realtime", "runs_dir", "budgets")
    given = [name for name in names if getattr(options, name) != getattr(default, name)]
    given += [name for name in ModelServerOptions.__dataclass_fields__ if name != "pair" and getattr(models, name) is not None]
    if given:
        raise InputError(
            f"The camera's server determines {', '.join(given)}. Remove these arguments. Use pair= to select one of its pairs."
        )

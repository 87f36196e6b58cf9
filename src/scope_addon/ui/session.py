"""The state of the add-on: the server, the connection, the current run, and the timer on the main thread."""

from __future__ import annotations

import secrets
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import bpy

from ..protocol.address import Address, parse_address
from ..protocol.errors import AddOnError
from ..protocol.instruction_run import InstructionRun, PictureStored, Problem, StepStarted
from ..protocol.link import CameraLink
from ..protocol.server import CAMERA, ServerProcess
from ..protocol.server_client import quote_part
from ..protocol.steps import End, Step
from ..protocol.tasks import RequestThread
from ..scene import cameras
from ..scene.executor import Executor
from . import picture_view, properties

CONNECTED_INTERVAL_S, STARTING_INTERVAL_S = 0.02, 0.1
"""Intervals of the timer in seconds, while connected and while the server starts."""

MAX_STEPS = 60  # the sidebar shows only the latest steps of a run
START_TIMEOUT_S = 60.0


class Session:
    """The state of the add-on, and the actions behind its buttons.

    All methods must be called on the main thread, and return immediately. ``tick`` must be called repeatedly.
    """

    def __init__(self) -> None:
        self.client = f"blender-{secrets.token_hex(6)}"
        self.camera = CAMERA
        self.problem = ""
        self.presets: list[str] = []
        self.steps: list[Step] = []
        self.end: End | None = None
        self.activity = ""
        self.run: InstructionRun | None = None
        self.executor: Executor | None = None
        self._server: ServerProcess | None = None
        self._server_start_s = 0.0
        self._link: CameraLink | None = None
        self._tasks: RequestThread | None = None
        self._address: Address | None = None
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._presets_requested = False
        self._seen_updates = 0

    @property
    def state(self) -> str:
        """``off``, ``starting``, ``connecting`` or ``connected``."""
        if self._link is not None:
            return "connected" if self._link.connected else "connecting"
        return "starting" if self._server is not None else "off"

    @property
    def server_url(self) -> str:
        """The address of the server; empty if there is none."""
        return self._address.url if self._address is not None else ""

    def start_server(self, program: str, pairs: list[str]) -> None:
        """Start a server, and connect to it when it is ready.

        Raises:
            AddOnError: The program cannot be started, or the scene has no camera.
        """
        self.disconnect()
        self.problem = ""
        cameras.describe(bpy.context.scene)  # raises an error for a scene without a camera before the server starts
        runs = Path(bpy.utils.user_resource("DATAFILES", path="scope_runs", create=True))
        self._server, self._server_start_s, self.camera = ServerProcess(program, pairs, runs), time.monotonic(), CAMERA

    def connect(self, url: str, token: str, camera: str) -> None:
        """Connect the open scene to a server.

        Raises:
            AddOnError: The address is invalid, or the scene has no camera.
        """
        self.disconnect()
        self.problem = ""
        address = parse_address(url, token)
        if not address.is_local and not getattr(bpy.app, "online_access", True):
            raise AddOnError("Blender's online access is off. Allow it in Preferences > System, or use a server on this machine.")
        self.camera = camera
        self._open(address)

    def disconnect(self) -> None:
        """Disconnect, and stop the server if the add-on started it."""
        if self.run is not None:
            self.run.abandon()
        if self._tasks is not None:
            self._tasks.stop()
        if self._link is not None:
            self._link.stop()
        if self.executor is not None:
            self.executor.close()
        if self._server is not None:
            self._server.stop()
            threading.Thread(target=self._server.wait, name="scope-server-end", daemon=True).start()
        self.run = self._tasks = self._link = self.executor = self._server = self._address = None
        self.presets, self._presets_requested, self.activity = [], False, ""
        properties.set_pairs([])

    def ask(self, instruction: str, pair: str) -> None:
        """Run an instruction.

        Raises:
            AddOnError: Blender is not connected, or a run is in progress.
        """
        if self._address is None or self.state != "connected":
            raise AddOnError("Connect to a server first.")
        if self.run is not None:
            raise AddOnError("An instruction is in progress. Wait until it ends, or cancel it.")
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="scope-", ignore_cleanup_errors=True)
        self.steps, self.end, self.activity, self.problem = [], None, "Planning the first step", ""
        chosen = "" if pair == "NONE" else pair
        self.run = InstructionRun(self._address, self.client, self.camera, instruction, chosen, Path(self._folder.name))
        self.run.start()

    def cancel(self) -> None:
        """Cancel the run in progress, if any."""
        if self.run is not None:
            self.activity = "Cancelling"
            self.run.cancel()

    def go_to_preset(self, name: str) -> None:
        """Go to a preset, in the background."""
        self._request("POST", f"/cameras/{quote_part(self.camera)}/presets/{quote_part(name)}/go")

    def go_home(self) -> None:
        """Go to the view of the scene's own camera, in the background."""
        self._request("POST", f"/cameras/{quote_part(self.camera)}/home")

    def save_preset(self, name: str) -> None:
        """Save the view of SCOPE's camera as a preset, in the background."""
        self._request("PUT", f"/cameras/{quote_part(self.camera)}/presets/{quote_part(name)}", {"description": ""})

    def remove_preset(self, name: str) -> None:
        """Remove a preset, in the background."""
        self._request("DELETE", f"/cameras/{quote_part(self.camera)}/presets/{quote_part(name)}")

    def scene_changed(self) -> None:
        """Send the new description of the scene, after the add-on has changed the cameras."""
        if self.executor is not None:
            self.executor.describe_now()

    def file_opened(self) -> None:
        """If connected, reconnect with the scene of the file that was opened."""
        if self._link is not None and self._address is not None:
            address, self.executor = self._address, None
            self._link.stop()
            try:
                self._connect_link(address)
            except AddOnError as error:
                self.disconnect()
                self.problem = str(error)

    def tick(self) -> float | None:
        """Process new events. Return the time in seconds until the next call; None if no more calls are needed."""
        redraw = self._watch_server()
        if self._link is not None:
            redraw |= self._watch_link(self._link)
        if self._tasks is not None:
            self._tasks.collect()
        if self.run is not None:
            redraw |= self._watch_run(self.run)
        if redraw:
            tag_redraw()
        return CONNECTED_INTERVAL_S if self._link is not None else STARTING_INTERVAL_S if self._server is not None else None

    def _watch_server(self) -> bool:
        server = self._server
        if server is None or self._link is not None:
            return False
        problem = server.problem
        if not problem and time.monotonic() - self._server_start_s > START_TIMEOUT_S:
            problem = f"The server did not start within {START_TIMEOUT_S:g} s."
        if problem:
            self.disconnect()
            self.problem = problem
        elif server.url:
            try:
                self._open(parse_address(server.url))
            except AddOnError as error:
                self.disconnect()
                self.problem = str(error)
        return True

    def _open(self, address: Address) -> None:
        self._connect_link(address)
        self._address = address
        self._tasks = RequestThread(address, self.client)

    def _connect_link(self, address: Address) -> None:
        description = cameras.describe(bpy.context.scene)
        self._link = CameraLink(address, self.camera, self.client, description)
        self._link.start()
        self.executor, self._presets_requested, self._seen_updates = Executor(self._link, description), False, 0

    def _watch_link(self, link: CameraLink) -> bool:
        if link.ended:
            problem = link.problem or "The connection has ended."
            if self._server is not None and self._server.problem:
                problem = self._server.problem
            self.disconnect()
            self.problem = problem
            return True
        if link.connected and not self._presets_requested:
            self._presets_requested = True
            self._request("GET", "/pairs", done=self._set_pairs)
            self._refresh_presets()
            return True
        if link.sent_updates != self._seen_updates:  # the server has received the scene's new cameras
            self._seen_updates = link.sent_updates
            self._refresh_presets()
        return self.executor is not None and self.executor.tick()

    def _watch_run(self, run: InstructionRun) -> bool:
        redraw = False
        while not run.events.empty():
            event, redraw = run.events.get(), True
            if isinstance(event, Step):
                self.steps = [*self.steps, event][-MAX_STEPS:]
                self.activity = f"Planning step {len(self.steps) + 1}"
            elif isinstance(event, StepStarted):
                self.activity = f"Working on step {event.step}"
            elif isinstance(event, PictureStored):
                picture_view.show(event.path)
            else:
                if isinstance(event, End):
                    self.end = event
                elif isinstance(event, Problem):
                    self.problem = event.text
                self.run, self.activity = None, ""
                self._refresh_presets()
        return redraw

    def _refresh_presets(self) -> None:
        self._request("GET", f"/cameras/{quote_part(self.camera)}/presets", done=self._set_presets)

    def _set_presets(self, reply: Any) -> None:
        self.presets = [str(preset["name"]) for preset in reply]

    def _set_pairs(self, reply: Any) -> None:
        properties.set_pairs([str(name) for name in reply])

    def _request(self, method: str, path: str, body: object = None, done: Any = None) -> None:
        if self._tasks is None:
            raise AddOnError("Connect to a server first.")

        def finished(reply: Any, problem: str) -> None:
            if problem:
                self.problem = problem
            elif done is not None:
                done(reply)
            else:
                self.problem = ""
                self._refresh_presets()
            tag_redraw()

        self._tasks.add(lambda client: client.request(method, path, body), finished)


def tag_redraw() -> None:
    """Redraw all 3D viewports and image editors."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in ("VIEW_3D", "IMAGE_EDITOR"):
                area.tag_redraw()


session = Session()
"""The session of this Blender instance."""


def on_timer() -> float | None:
    """Call ``tick``. Registered with ``bpy.app.timers`` while connected or connecting."""
    return session.tick()


def wake() -> None:
    """Register the timer if it is not registered."""
    if not bpy.app.timers.is_registered(on_timer):
        bpy.app.timers.register(on_timer, first_interval=0.0, persistent=True)

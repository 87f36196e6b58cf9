"""``scope chat``: several runs that share a camera and their history."""

from __future__ import annotations

from concurrent.futures import CancelledError
from contextlib import suppress
from threading import Event

from anyio.from_thread import BlockingPortal, start_blocking_portal
from rich.console import Console
from rich.text import Text

from scope_ptz.agent.filmstrip import write_filmstrip
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import read_trace
from scope_ptz.cli.asking import Asking, Session
from scope_ptz.cli.display import LiveView, plain, show_end
from scope_ptz.cli.endings import complain
from scope_ptz.errors import InputError
from scope_ptz.planner.base import PastTurn

_PROMPT = "› "
_HELP = "/pose: where the camera looks; /save: keep a picture of it; /quit: the end. Anything else is an instruction."


def chat(options: Asking) -> int:
    """Talk until /quit or the end of the input; the exit code.

    Lines are read in the main thread and carried out in another one, so that Ctrl-C always reaches the person's side: during a run
    it cancels the run, at the prompt it ends the program.
    """
    with start_blocking_portal() as portal:
        session = portal.call(Session.open, options)
        try:
            _talk(portal, _Chat(session, options))
        finally:
            portal.call(session.close)
    return 0


def _talk(portal: BlockingPortal, chat: _Chat) -> None:
    chat.console.print(Text(_HELP, style="dim"))
    while True:
        try:
            line = input(_PROMPT).strip()
        except EOFError:
            return
        if line == "/quit":
            return
        if not line:
            continue
        chat.idle.clear()
        turn = portal.start_task_soon(chat.turn, line)
        try:
            turn.result()
        except InputError as error:
            complain(str(error))
        except KeyboardInterrupt:
            turn.cancel()
            chat.idle.wait()
            with suppress(CancelledError):
                turn.result()
            complain("the run was cancelled; /quit ends the chat.")


class _Chat:
    """What a conversation keeps: its turns, and a folder for pictures once one is saved."""

    def __init__(self, session: Session, options: Asking) -> None:
        self.session, self.options, self.console = session, options, Console(highlight=False)
        self.turns: tuple[PastTurn, ...] = ()
        self.kept: RunFolder | None = None
        self.idle = Event()

    async def turn(self, line: str) -> None:
        """A small command or an instruction. ``idle`` is set when it is over, also by cancellation."""
        try:
            if line.startswith("/"):
                await self._command(line)
            else:
                await self._instruct(line)
        finally:
            self.idle.set()

    async def _command(self, line: str) -> None:
        if line == "/pose":
            pose = (await self.session.camera.pose()).as_dict()
            self.console.print(f"pan {pose['pan_deg']:g}°, tilt {pose['tilt_deg']:g}°, zoom {pose['zoom']:g}x")
        elif line == "/save":
            self.kept = self.kept or RunFolder.create(self.options.runs_dir, "chat pictures")
            name = self.kept.save_picture(await self.session.camera.frame())
            self.console.print(Text(f"Saved {self.kept.path / name}"), soft_wrap=True)
        else:
            raise InputError(f"There is no command {plain(line.split()[0])}. {_HELP}")

    async def _instruct(self, instruction: str) -> None:
        folder = RunFolder.create(self.options.runs_dir, instruction)
        view = LiveView(self.console)
        try:
            run = await self.session.run(instruction, folder, view, self.turns)
        finally:
            folder.discard_if_empty()
        self.turns = (*self.turns, run.past_turn())
        filmstrip = write_filmstrip(read_trace(folder.path))
        show_end(self.console, run.ended, self.session.note, folder.path, filmstrip)

"""``scope chat``: a conversation in which several runs share a camera and a history."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Event

from anyio.from_thread import BlockingPortal, start_blocking_portal
from platformdirs import user_state_path
from rich.console import Console
from rich.text import Text

from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import read_trace
from scope_ptz.cli.ask import Session, make_filmstrip
from scope_ptz.cli.display import BriefView, sanitize, show_brief_end, show_planned
from scope_ptz.cli.exit import has_input, print_error
from scope_ptz.cli.options import SessionFlags
from scope_ptz.errors import InputError
from scope_ptz.factory.models import ModelOptions
from scope_ptz.planner.base import PastTurn

MAX_HISTORY_LINES = 1000
_PROMPT = "› "
_WELCOME = "Type what the camera should do. /help lists the commands, /quit ends the chat."
_HELP = """\
/pose   print where the camera points
/save   save a picture of the current view
/help   print this list
/quit   end the chat (so does Ctrl-D)
Ctrl-C cancels a run. Everything else is an instruction, for example: pan right 20 and count the cars"""


def chat(flags: SessionFlags, models: ModelOptions) -> int:
    """Carry out instructions until /quit or the end of the input, and return the exit code.

    The main thread reads lines, and another thread executes them, so that Ctrl-C always reaches the main thread.
    During a run, Ctrl-C cancels the run. At the prompt, Ctrl-C ends the program.
    """
    if not has_input():
        raise InputError("Standard input is closed, so the chat cannot start. Use `scope ask` for one instruction.")
    with start_blocking_portal() as portal, _line_editing():
        session = portal.call(_open, flags, models)
        try:
            _read_and_run(portal, _Chat(session))
        finally:
            portal.call(session.close)
    return 0


async def _open(flags: SessionFlags, models: ModelOptions) -> Session:
    return await Session.open(flags, models, realtime=flags.in_real_time())


def _read_and_run(portal: BlockingPortal, chat: _Chat) -> None:
    interactive = sys.stdin.isatty()
    chat.console.print(Text(_WELCOME, style="dim"))
    if chat.session.note:
        chat.console.print(Text(chat.session.note, style="yellow"))
    while True:
        try:
            line = input(_PROMPT if interactive else "").strip()
        except EOFError:
            if interactive:
                chat.console.print()
            return
        except OSError as error:
            raise InputError(f"Standard input cannot be read: {error.strerror}.") from error
        if line == "/quit":
            return
        if not line:
            continue
        chat.idle.clear()
        turn = portal.start_task_soon(chat.turn, line)
        try:
            turn.result()
        except InputError as error:
            print_error(str(error))
        except KeyboardInterrupt:
            turn.cancel()
            chat.idle.wait()
            with suppress(CancelledError):
                turn.result()
            print_error("the run was cancelled; /quit ends the chat.")


class _Chat:
    """A conversation, with its turns so far and, once a picture has been saved, the folder of its pictures."""

    def __init__(self, session: Session) -> None:
        self.session, self.console = session, Console(highlight=False)
        self.turns: tuple[PastTurn, ...] = ()
        self.picture_folder: RunFolder | None = None
        self.idle = Event()

    async def turn(self, line: str) -> None:
        """Carry out a chat command or an instruction. ``idle`` is set at the end, even after a cancellation."""
        try:
            if line.startswith("/"):
                await self._command(line)
            else:
                await self._instruct(line)
        finally:
            self.idle.set()

    async def _command(self, line: str) -> None:
        if line == "/help":
            self.console.print(Text(_HELP, style="dim"))
        elif line == "/pose":
            pose = (await self.session.camera.pose()).as_dict()
            self.console.print(f"pan {pose['pan_deg']:g}°, tilt {pose['tilt_deg']:g}°, zoom {pose['zoom']:g}x")
        elif line == "/save":
            self.picture_folder = self.picture_folder or RunFolder.create(self.session.runs_dir, "chat pictures")
            name = await self.picture_folder.save_picture(await self.session.camera.frame())
            self.console.print(Text(f"Saved {self.picture_folder.path / name}"), soft_wrap=True)
        else:
            raise InputError(f"There is no command {sanitize(line.split()[0])}. Type /help to list the commands.")

    async def _instruct(self, instruction: str) -> None:
        folder = RunFolder.create(self.session.runs_dir, instruction)
        self.session.planned_commands.clear()
        try:
            view = BriefView(self.console, echoes=not sys.stdin.isatty())
            result = await self.session.run(instruction, folder, view, self.turns)
        finally:
            folder.discard_if_not_started()
        self.turns = (*self.turns, result.past_turn())
        if self.session.flags.dry_run:
            show_planned(self.console, self.session.planned_commands)
        filmstrip = make_filmstrip(read_trace(folder.path))
        show_brief_end(self.console, result.ended, folder.path if filmstrip is not None else None)


@contextmanager
def _line_editing() -> Iterator[None]:
    """Enable line editing and a persistent history, if standard input is a terminal and ``readline`` is available."""
    try:
        import readline
    except ImportError:  # on Windows, the console itself supports line editing
        yield
        return
    if not sys.stdin.isatty():
        yield
        return
    path = user_state_path("scope-ptz") / "chat_history"
    readline.set_history_length(MAX_HISTORY_LINES)
    with suppress(OSError):
        readline.read_history_file(path)
    try:
        yield
    finally:
        with suppress(OSError):
            _make_private(path)
            readline.write_history_file(path)


def _make_private(path: Path) -> None:
    """Create a file that only its owner can read, because instructions may be confidential."""
    path.parent.mkdir(parents=True, exist_ok=True)
    os.close(os.open(path, os.O_CREAT | os.O_WRONLY, 0o600))
    path.chmod(0o600)

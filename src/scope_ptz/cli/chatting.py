"""``scope chat``: several runs that share a camera and their history."""

from __future__ import annotations

import anyio
from anyio import to_thread
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

_HELP = "/pose: where the camera looks; /save: keep a picture of it; /quit: the end. Anything else is an instruction."


class _Chat:
    def __init__(self, session: Session, options: Asking) -> None:
        self.session, self.options, self.console = session, options, Console(highlight=False)
        self.turns: tuple[PastTurn, ...] = ()
        self.kept: RunFolder | None = None

    async def talk(self) -> None:
        self.console.print(Text(_HELP, style="dim"))
        while True:
            try:
                line = (await to_thread.run_sync(input, "› ", abandon_on_cancel=True)).strip()
            except EOFError:
                return
            if line == "/quit":
                return
            if line:
                try:
                    await self.turn(line)
                except InputError as error:
                    complain(str(error))

    async def turn(self, line: str) -> None:
        if line == "/pose":
            pose = (await self.session.camera.pose()).as_dict()
            self.console.print(f"pan {pose['pan_deg']:g}°, tilt {pose['tilt_deg']:g}°, zoom {pose['zoom']:g}x")
        elif line == "/save":
            self.kept = self.kept or RunFolder.create(self.options.runs_dir, "chat pictures")
            name = self.kept.save_picture(await self.session.camera.frame())
            self.console.print(Text(f"Saved {self.kept.path / name}"), soft_wrap=True)
        elif line.startswith("/"):
            raise InputError(f"There is no command {plain(line.split()[0])}. {_HELP}")
        else:
            await self.instruct(line)

    async def instruct(self, instruction: str) -> None:
        folder = RunFolder.create(self.options.runs_dir, instruction)
        try:
            run = await self.session.run(instruction, folder, LiveView(self.console), self.turns)
        finally:
            folder.discard_if_empty()
        self.turns = (*self.turns, run.past_turn())
        filmstrip = await to_thread.run_sync(write_filmstrip, read_trace(folder.path))
        show_end(self.console, run.ended, self.session.note, folder.path, filmstrip)


def chat(options: Asking) -> int:
    """Talk until /quit or the end of the input; the exit code."""

    async def work() -> None:
        session = await Session.open(options)
        try:
            await _Chat(session, options).talk()
        finally:
            with anyio.CancelScope(shield=True):
                await session.close()

    anyio.run(work)
    return 0

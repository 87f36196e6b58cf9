"""``scope doctor --planner-url ...``: whether a server does what a planner or eyes need of it."""

from __future__ import annotations

from collections.abc import AsyncIterator

import anyio
from rich.console import Console
from rich.text import Text

from scope_ptz.builtin_names import DEFAULT_SCENE
from scope_ptz.cli.display import plain
from scope_ptz.cli.endings import FAILED, put_json
from scope_ptz.endpoints.chat_server_checks import LAST, ServerCheck, Verdict, check_chat
from scope_ptz.errors import InputError
from scope_ptz.factory.cameras import open_camera
from scope_ptz.factory.models import ModelOptions, ResolvedPerception, ResolvedPlanner, make_perception, resolve_models

THING = "traffic cone"
"""What the demo scene's home view certainly shows."""
_PRESET = "highway"
_MARKS: dict[Verdict, tuple[str, str]] = {"ok": ("ok", "green"), "partly": ("--", "yellow"), "failed": ("!!", "bold red")}


def check_servers(wishes: ModelOptions, *, as_json: bool) -> int:
    """Print every check as it ends; exit code 1 when one of them failed."""
    found: list[tuple[str, ServerCheck]] = []
    console = Console(highlight=False)

    async def work() -> None:
        choice = await resolve_models(wishes)
        if choice.planner.endpoint is None and choice.perception.spec is None:
            raise InputError("There is no server to check. Name one with --planner-url, or with --perception and --perception-url.")
        async for about, check in _checks(choice.planner, choice.perception):
            found.append((about, check))
            if not as_json:
                _show(console, about, check)

    anyio.run(work)
    if as_json:
        put_json([{"server": about, **check.model_dump()} for about, check in found])
    return FAILED if any(check.verdict == "failed" for _, check in found) else 0


async def _checks(planner: ResolvedPlanner, eyes: ResolvedPerception) -> AsyncIterator[tuple[str, ServerCheck]]:
    if planner.endpoint is not None:
        from scope_ptz.planner.chat.planning_checks import check_planning
        from scope_ptz.tools.registry import schemas

        about, alive = f"planner {planner.name}".strip(), False
        async for check in check_chat(planner.endpoint):
            alive = check.what == LAST
            yield about, check
        if alive:
            async for check in check_planning(planner.endpoint, schemas(), planner.options):
                yield about, check
    if eyes.spec is not None:
        from scope_ptz.perception.models.vision_checks import check_perception

        async with await open_camera(DEFAULT_SCENE, preset=_PRESET) as opened:
            perception = make_perception(eyes, opened.scenes, 0)
            try:
                async for check in check_perception(perception, await opened.camera.frame(), thing=THING):
                    yield f"eyes {eyes.name}", check
            finally:
                await perception.close()


def _show(console: Console, about: str, check: ServerCheck) -> None:
    mark, style = _MARKS[check.verdict]
    head = Text.assemble((f"{mark}  ", style), (f"{plain(about)}: {check.what}", "bold"), (f"  {check.seconds:.2f} s  ", "dim"))
    console.print(head + Text(plain(check.detail)), soft_wrap=True)

"""``scope camera focus|iris``: adjust a camera's lens manually."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from scope_ptz.cli.camera.manual_control import CameraSpecArgument, DryRunOption, open_for_command
from scope_ptz.cli.exit import put, put_json, run_async
from scope_ptz.cli.options import JsonOption

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from scope_ptz.camera.base import Camera
    from scope_ptz.camera.lens import FocusAction, IrisAction, LensState

Step = Annotated[float, typer.Option("--step", help="Size of a step, as a fraction of the range.")]


def focus(
    camera: CameraSpecArgument,
    action: Annotated[
        str | None, typer.Argument(help="auto, manual (hold), once (focus and hold), near, or far. Without it, print the focus.")
    ] = None,
    step: Step = 0.05,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """Set the focus, or print it."""

    async def adjust(opened_camera: Camera) -> LensState:
        return await (opened_camera.lens() if action is None else opened_camera.set_focus(cast("FocusAction", action), step=step))

    _run(camera, adjust, "focus", dry_run=dry_run, as_json=as_json)


def iris(
    camera: CameraSpecArgument,
    action: Annotated[str | None, typer.Argument(help="auto, manual (hold), open, or close. Without it, print the iris.")] = None,
    step: Step = 0.05,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """Set the iris, or print it."""

    async def adjust(opened_camera: Camera) -> LensState:
        return await (opened_camera.lens() if action is None else opened_camera.set_iris(cast("IrisAction", action), step=step))

    _run(camera, adjust, "iris", dry_run=dry_run, as_json=as_json)


def _run(
    spec: str, adjust: Callable[[Camera], Awaitable[LensState]], setting: str, *, dry_run: bool, as_json: bool
) -> None:  # fmt: skip
    async def work() -> None:
        async with open_for_command(spec, dry_run=dry_run) as opened_camera:
            state = await adjust(opened_camera)
        put_json(asdict(state)) if as_json else put(_lens_text(state, setting))

    run_async(work)


def _lens_text(state: LensState, setting: str) -> str:
    values: tuple[Any, Any] = (state.autofocus, state.focus) if setting == "focus" else (state.autoiris, state.iris)
    mode = {True: "automatic", False: "manual", None: "mode not reported"}[values[0]]
    ends = "near to far" if setting == "focus" else "closed to open"
    position = "position not reported" if values[1] is None else f"at {values[1]:.0%} from {ends}"
    return f"{setting}: {mode}, {position}"

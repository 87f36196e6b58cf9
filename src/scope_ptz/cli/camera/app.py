"""The ``scope camera`` app, with its commands grouped as in the help."""

from __future__ import annotations

from collections.abc import Callable

import typer

from scope_ptz.cli.camera import HELP
from scope_ptz.cli.camera.capture import capture
from scope_ptz.cli.camera.lens import focus, iris
from scope_ptz.cli.camera.manual_control import move, password, presets, snapshot, watch
from scope_ptz.cli.camera.measure import calibrate, discover, probe
from scope_ptz.cli.camera.serve import serve
from scope_ptz.cli.options import command

FIND, CONTROL, TEST = "Find and measure", "Control by hand", "Virtual camera"

camera_app = typer.Typer(help=HELP, no_args_is_help=True)


@camera_app.callback(help=HELP)
def _camera() -> None:
    """Define the group of camera commands."""


COMMANDS: tuple[tuple[str, str, Callable[..., int | None]], ...] = (
    (FIND, "discover", discover),
    (FIND, "probe", probe),
    (FIND, "calibrate", calibrate),
    (FIND, "capture", capture),
    (CONTROL, "snapshot", snapshot),
    (CONTROL, "move", move),
    (CONTROL, "focus", focus),
    (CONTROL, "iris", iris),
    (CONTROL, "presets", presets),
    (CONTROL, "watch", watch),
    (CONTROL, "password", password),
    (TEST, "serve", serve),
)
"""Help panel, name and function of each command."""

for panel, name, function in COMMANDS:
    camera_app.command(name, rich_help_panel=panel)(command(function))

"""The ``scope camera`` commands, grouped as in the help. They are imported when one of them is used or listed."""

from __future__ import annotations

import typer

from scope_ptz.cli.typer_extensions import LazyGroup, command

HELP = """Real cameras on the network, and virtual ones for tests.

Start with `scope camera discover` to find cameras, or `scope camera serve` for a virtual one.
"""
FIND, CONTROL, TEST = "Find and measure", "Control by hand", "Virtual camera"


class CameraGroup(LazyGroup):
    """The commands for real and virtual cameras."""

    def load_app(self) -> typer.Typer:
        from scope_ptz.cli.camera.capture import capture
        from scope_ptz.cli.camera.manual_control import focus, iris, move, password, presets, snapshot, watch
        from scope_ptz.cli.camera.measure import calibrate, discover, probe
        from scope_ptz.cli.camera.serve import serve

        panels = {
            FIND: (discover, probe, calibrate, capture),
            CONTROL: (snapshot, move, focus, iris, presets, watch, password),
            TEST: (serve,),
        }
        camera_app = typer.Typer()
        for panel, functions in panels.items():
            for function in functions:
                camera_app.command(function.__name__, rich_help_panel=panel)(command(function))
        return camera_app

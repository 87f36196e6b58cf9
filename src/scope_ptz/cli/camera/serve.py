"""``scope camera serve``: virtual cameras for tests of software for real ones."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.factory.virtual_cameras import VirtualCameraOptions
    from scope_ptz.virtual_camera.accounts import Account
    from scope_ptz.virtual_camera.http.server import ServedCamera


DEFAULT_RTSP_PORT = 8554  # 554 is reserved for the system


def serve(
    scene: Annotated[list[str], typer.Option("--scene", help="Scene of a camera; see `scope scene list` (repeatable).")],
    viewpoint: Annotated[
        list[str] | None, typer.Option("--viewpoint", help="Viewpoint of each camera (default: the scene's home; repeatable).")
    ] = None,
    host: Annotated[str, typer.Option("--host", help="Address to listen at.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port of the first camera; further ones follow. 0: any.")
    ] = 8080,
    rtsp_port: Annotated[
        int | None,
        typer.Option("--rtsp-port", min=0, max=65535, help="The same for RTSP (default: 8554; any if --port is 0)."),
    ] = None,
    user: Annotated[
        list[str] | None,
        typer.Option(
            "--user", metavar="NAME[:ROLE]", help="Account: viewer, operator or administrator (default: root; repeatable)."
        ),
    ] = None,
    no_accounts: Annotated[bool, typer.Option("--no-accounts", help="Ask nobody for a password (on this machine only).")] = False,
    time_scale: Annotated[float, typer.Option("--time-scale", help="How many times faster than real the motors are.")] = 1.0,
    hold_time: Annotated[bool, typer.Option("--hold-time", help="Hold scene time: actors stand still.")] = False,
    latency: Annotated[float, typer.Option("--latency", min=0.0, max=5.0, help="Seconds from exposure to stream.")] = 0.1,
    fault: Annotated[
        list[str] | None,
        typer.Option("--fault", metavar="NAME=VALUE", help="Fault to show, for example stall_s=2 (repeatable)."),
    ] = None,
    prefetch: Annotated[
        bool, typer.Option("--prefetch/--no-prefetch", help="Read viewpoints at the start: no stalls, more memory (default: on).")
    ] = True,
    truth: Annotated[bool, typer.Option("--truth", help="Give programs on this machine the ground truth of frames.")] = False,
    no_discovery: Annotated[bool, typer.Option("--no-discovery", help="Do not answer WS-Discovery (ONVIF).")] = False,
    as_json: JsonOption = False,
) -> None:
    """Serve virtual cameras on the network until Ctrl-C."""
    from scope_ptz.cli.exit import run_async
    from scope_ptz.factory.virtual_cameras import VirtualCameraOptions, make_accounts, make_devices, serve_virtual_cameras
    from scope_ptz.settings import load_settings

    if no_accounts and user:
        raise InputError("Give --user or --no-accounts, not both.")
    settings = load_settings()
    accounts = [] if no_accounts else make_accounts(user or ["root"], settings)
    options = VirtualCameraOptions(
        scenes=tuple(scene),
        viewpoints=tuple(viewpoint or ()),
        host=host,
        port=port,
        rtsp_port=rtsp_port if rtsp_port is not None else DEFAULT_RTSP_PORT if port else 0,
        time_scale=time_scale,
        hold_time=hold_time,
        latency_s=latency,
        faults=parse_faults(fault or []),
        truth=truth,
        discovery=not no_discovery,
        prefetch=prefetch,
    )
    devices = make_devices(options, accounts)
    shown = [] if settings.virtual_camera_password else accounts

    async def run() -> None:
        import anyio

        async with serve_virtual_cameras(devices, options) as cameras:
            _print(cameras, accounts, shown, options, as_json=as_json)
            await anyio.sleep_forever()

    run_async(run)


def parse_faults(texts: Sequence[str]) -> dict[str, object]:
    """Return faults from ``NAME=VALUE`` texts. Values are numbers, true and false, words, or words with commas.

    Raises:
        InputError: A text has no equals sign.
    """
    faults: dict[str, object] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"A fault is NAME=VALUE, for example stall_s=2, got '{text[:60]}'.")
        if name == "stuck":
            faults[name] = [axis for axis in value.split(",") if axis]
            continue
        try:
            faults[name] = json.loads(value)
        except ValueError:
            faults[name] = value
    return faults


def _print(
    cameras: Sequence[ServedCamera],
    accounts: Sequence[Account],
    shown: Sequence[Account],
    options: VirtualCameraOptions,
    *,
    as_json: bool,
) -> None:
    """Print addresses and accounts. Passwords that were made up are shown, once."""
    import sys

    from scope_ptz.cli.exit import put, put_json

    if as_json:
        passwords = {account.name: account.password for account in shown}
        rows: list[dict[str, Any]] = [
            {"scene": each.device.scene.name, "viewpoint": each.device.viewpoint, "url": each.url, "rtsp_url": each.rtsp_url}
            for each in cameras
        ]
        put_json({"cameras": rows, "users": [account.name for account in accounts], "passwords": passwords})
    else:
        for each in cameras:
            put(f"{each.device.name}: {each.url} (ONVIF: {each.url}/onvif/device_service, RTSP: {each.rtsp_url})")
        for account in accounts:
            secret = f"password {account.password}" if account in shown else "password from SCOPE_VIRTUAL_CAMERA_PASSWORD"
            put(f"Account {account.name} ({account.role.name.lower()}), {secret}")
        sign_in = f"--digest --user {accounts[0].name} " if accounts else ""
        in_url = f"{accounts[0].name}:PASSWORD@" if accounts else ""
        url = cameras[0].url
        put("")
        put("Try:")
        put(f"  curl {sign_in}-o picture.jpg {url}/axis-cgi/jpg/image.cgi")
        put(f"  curl {sign_in}'{url}/axis-cgi/com/ptz.cgi?rpan=20'")
        put(f"  ffplay {url.replace('http://', f'http://{in_url}')}/axis-cgi/mjpg/video.cgi")
        put(f"  ffplay {(cameras[0].rtsp_url or '').replace('rtsp://', f'rtsp://{in_url}')}")
        if options.truth:
            put(f"  curl {sign_in}{url}/virtual/truth")
        put("")
        put("Press Ctrl-C to stop.")
    sys.stdout.flush()

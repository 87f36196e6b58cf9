"""``scope camera serve``: serve virtual cameras for testing software that controls real cameras."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scope_ptz.factory.cameras.virtual import VirtualCameraOptions
    from scope_ptz.virtual_camera.accounts import Account
    from scope_ptz.virtual_camera.http.server import ServedCamera


DEFAULT_RTSP_PORT = 8554  # the standard port, 554, requires administrator rights


def serve(
    scene: Annotated[list[str], typer.Option("--scene", help="Scene of a camera; see `scope scene list` (repeatable).")],
    viewpoint: Annotated[
        list[str] | None, typer.Option("--viewpoint", help="Viewpoint of each camera (default: the scene's home; repeatable).")
    ] = None,
    host: Annotated[str, typer.Option("--host", help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int,
        typer.Option(
            "--port",
            min=0,
            max=65535,
            help="Port of the first camera; further cameras use the following ports. 0 lets the system choose.",
        ),
    ] = 8080,
    rtsp_port: Annotated[
        int | None,
        typer.Option(
            "--rtsp-port",
            min=0,
            max=65535,
            help="RTSP port of the first camera (default: 8554, or chosen by the system if --port is 0).",
        ),
    ] = None,
    user: Annotated[
        list[str] | None,
        typer.Option(
            "--user", metavar="NAME[:ROLE]", help="Account: viewer, operator or administrator (default: root; repeatable)."
        ),
    ] = None,
    no_accounts: Annotated[
        bool, typer.Option("--no-accounts", help="Require no password. Only clients on this machine can connect.")
    ] = False,
    time_scale: Annotated[float, typer.Option("--time-scale", help="Speed of the motors, as a multiple of the real speed.")] = 1.0,
    hold_time: Annotated[bool, typer.Option("--hold-time", help="Stop scene time, so that actors do not move.")] = False,
    latency: Annotated[
        float, typer.Option("--latency", min=0.0, max=5.0, help="Seconds from exposure until a frame is sent.")
    ] = 0.1,
    fault: Annotated[
        list[str] | None,
        typer.Option("--fault", metavar="NAME=VALUE", help="Fault to simulate, for example stall_s=2 (repeatable)."),
    ] = None,
    prefetch: Annotated[
        bool,
        typer.Option(
            "--prefetch/--no-prefetch",
            help="Read all pictures at startup, which avoids stalls but needs more memory (default: on).",
        ),
    ] = True,
    https: Annotated[
        bool, typer.Option("--https", help="Serve HTTPS with a new self-signed certificate, and print its fingerprint.")
    ] = False,
    truth: Annotated[bool, typer.Option("--truth", help="Serve the ground truth of frames to programs on this machine.")] = False,
    no_discovery: Annotated[bool, typer.Option("--no-discovery", help="Do not answer WS-Discovery (ONVIF).")] = False,
    as_json: JsonOption = False,
) -> None:
    """Serve virtual cameras on the network until Ctrl-C."""
    from scope_ptz.cli.exit import run_async
    from scope_ptz.factory.cameras.virtual import VirtualCameraOptions, make_accounts, make_devices, serve_virtual_cameras
    from scope_ptz.settings import load_settings
    from scope_ptz.virtual_camera.heap import release_memory_regularly, use_one_heap

    use_one_heap()
    if no_accounts and user:
        raise InputError("Give either --user or --no-accounts, not both.")
    settings = load_settings()
    accounts = [] if no_accounts else make_accounts(user or ["root"], settings)
    options = VirtualCameraOptions(
        scenes=tuple(scene),
        viewpoints=tuple(viewpoint or ()),
        host=host,
        port=port,
        rtsp_port=rtsp_port if rtsp_port is not None else DEFAULT_RTSP_PORT if port else 0,
        time_scale=time_scale,
        freeze_time=hold_time,
        latency_s=latency,
        faults=parse_faults(fault or []),
        truth=truth,
        https=https,
        discovery=not no_discovery,
        prefetch=prefetch,
    )
    devices = make_devices(options, accounts)
    generated_accounts = [] if settings.virtual_camera_password else accounts

    async def run() -> None:
        async with serve_virtual_cameras(devices, options) as cameras:
            _print_summary(cameras, accounts, generated_accounts, options, as_json=as_json)
            await release_memory_regularly()

    run_async(run)


def parse_faults(arguments: Sequence[str]) -> dict[str, object]:
    """Parse faults in the form ``NAME=VALUE``. A value is a number, true, false, a word, or words separated by commas.

    Raises:
        InputError: An argument has no equals sign.
    """
    faults: dict[str, object] = {}
    for argument in arguments:
        name, separator, value = argument.partition("=")
        if not separator:
            raise InputError(f"A fault must have the form NAME=VALUE, for example stall_s=2; got '{argument[:60]}'.")
        if name == "stuck":
            faults[name] = [axis for axis in value.split(",") if axis]
            continue
        try:
            faults[name] = json.loads(value)
        except ValueError:
            faults[name] = value
    return faults


def _print_summary(
    cameras: Sequence[ServedCamera],
    accounts: Sequence[Account],
    generated_accounts: Sequence[Account],
    options: VirtualCameraOptions,
    *,
    as_json: bool,
) -> None:
    """Print addresses, accounts and example commands. ``generated_accounts`` contains the accounts whose passwords are printed."""
    import sys

    from scope_ptz.cli.exit import put, put_json

    if as_json:
        passwords = {account.name: account.password for account in generated_accounts}
        rows: list[dict[str, Any]] = [
            {
                "scene": camera.device.scene.name,
                "viewpoint": camera.device.viewpoint,
                "url": camera.url,
                "rtsp_url": camera.rtsp_url,
                **({} if camera.certificate is None else {"fingerprint": camera.certificate.fingerprint}),
            }
            for camera in cameras
        ]
        put_json({"cameras": rows, "users": [account.name for account in accounts], "passwords": passwords})
    else:
        for camera in cameras:
            put(f"{camera.device.name}: {camera.url}")
            put(f"  ONVIF: {camera.url}/onvif/device_service")
            put(f"  RTSP:  {camera.rtsp_url}")
            if camera.certificate is not None:
                put(f"  certificate (SHA-256): {camera.certificate.fingerprint}")
        for account in accounts:
            secret = (
                f"password {account.password}" if account in generated_accounts else "password from SCOPE_VIRTUAL_CAMERA_PASSWORD"
            )
            put(f"Account {account.name} ({account.role.name.lower()}), {secret}")
        insecure = "--insecure " if options.https else ""
        curl_options = insecure + (f"--digest --user {accounts[0].name} " if accounts else "")
        credentials = f"{accounts[0].name}:PASSWORD@" if accounts else ""
        url = cameras[0].url
        put("")
        put("Try:")
        put(f"  curl {curl_options}-o picture.jpg {url}/axis-cgi/jpg/image.cgi")
        put(f"  curl {curl_options}'{url}/axis-cgi/com/ptz.cgi?rpan=20'")
        put(f"  ffplay {url.replace('://', f'://{credentials}')}/axis-cgi/mjpg/video.cgi")
        put(f"  ffplay {(cameras[0].rtsp_url or '').replace('rtsp://', f'rtsp://{credentials}')}")
        if options.truth:
            put(f"  curl {curl_options}{url}/virtual/truth")
        put("")
        put("Press Ctrl-C to stop.")
    sys.stdout.flush()

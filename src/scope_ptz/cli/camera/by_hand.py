"""``scope camera snapshot|move|presets|watch|password``: a camera by hand."""

from __future__ import annotations

import getpass
import math
import sys
from contextlib import aclosing, asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from scope_ptz.cli.exit import print_error, put, put_json, run_async
from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import InputError, OutputError

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from scope_ptz.camera.base import Arrival, Camera, Frame

CameraSpecArgument = Annotated[
    str, typer.Argument(metavar="CAMERA", help="Camera: a name in scope.yaml, axis://USER@HOST, onvif://USER@HOST, sim:SCENE, ...")
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Say what the camera would do, and do nothing.")]


def snapshot(
    camera: CameraSpecArgument,
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write (.jpg or .png).")] = Path("snapshot.jpg"),
    full: Annotated[bool, typer.Option("--full", help="Sweep the camera's whole range into one panorama.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Take a picture."""

    from scope_ptz.tools.sweep import sweep

    async def work() -> None:
        async with _opened(camera) as opened:
            frame = await (sweep(opened) if full else opened.frame())
        _write_picture(frame, out)
        where = {"file": str(out), "width": frame.width, "height": frame.height, **frame.pose.as_dict()}
        if as_json:
            put_json({**where, "hfov_deg": round(frame.hfov_deg, 2)})
        else:
            put(f"{out}: {frame.width}x{frame.height}, {_pose_text(where)}, {frame.hfov_deg:.1f} degrees wide")

    run_async(work)


def move(
    camera: CameraSpecArgument,
    pan: Annotated[float | None, typer.Option("--pan", help="Pan in degrees, absolute.")] = None,
    tilt: Annotated[float | None, typer.Option("--tilt", help="Tilt in degrees, absolute.")] = None,
    zoom: Annotated[float | None, typer.Option("--zoom", help="Magnification, absolute.")] = None,
    by_pan: Annotated[float, typer.Option("--by-pan", help="Degrees to turn right.")] = 0.0,
    by_tilt: Annotated[float, typer.Option("--by-tilt", help="Degrees to turn up.")] = 0.0,
    preset: Annotated[str | None, typer.Option("--preset", help="Go to a preset.")] = None,
    home: Annotated[bool, typer.Option("--home", help="Go home.")] = False,
    stop: Annotated[bool, typer.Option("--stop", help="Stop any motion.")] = False,
    dry_run: DryRun = False,
    as_json: JsonOption = False,
) -> None:
    """Move the camera to a pose, by an angle, to a preset or home. Without options, print where it is."""
    numbers = [value for value in (pan, tilt, zoom, by_pan, by_tilt) if value is not None]
    if not all(math.isfinite(value) for value in numbers) or (zoom is not None and zoom <= 0):
        raise InputError("Angles are finite numbers of degrees, and the magnification is above 0.")
    by_pose = pan is not None or tilt is not None or zoom is not None or by_pan != 0.0 or by_tilt != 0.0
    if sum((by_pose, preset is not None, home, stop)) > 1:
        raise InputError("Give one target: a pose, --preset, --home, or --stop.")

    async def carry_out(opened: Camera) -> Arrival | None:
        if stop:
            await opened.stop()
        elif preset is not None:
            return await opened.go_to_preset(preset)
        elif home:
            return await opened.go_home()
        elif by_pose:
            start = await opened.pose()
            given = {"pan_deg": pan, "tilt_deg": tilt, "zoom": zoom}
            target = replace(start, **{name: value for name, value in given.items() if value is not None})
            return await opened.move(target.turned(by_pan, by_tilt))
        return None

    async def work() -> None:
        async with _opened(camera, dry_run=dry_run) as opened:
            arrival = await carry_out(opened)
            pose = (await opened.pose() if arrival is None else arrival.pose).as_dict()
        clamped = () if arrival is None else arrival.clamped
        held_back = "" if arrival is None else arrival.limited_by
        if as_json:
            put_json({**pose, "clamped": list(clamped), "limited_by": held_back})
            return
        note = f"; held back by {held_back}" if held_back else f"; stopped by the {' and '.join(clamped)} limit" if clamped else ""
        put(_pose_text(pose) + note)

    run_async(work)


def presets(
    camera: CameraSpecArgument,
    save: Annotated[str | None, typer.Option("--save", metavar="NAME", help="Save the current pose.")] = None,
    remove: Annotated[str | None, typer.Option("--remove", metavar="NAME", help="Remove a preset.")] = None,
    dry_run: DryRun = False,
    as_json: JsonOption = False,
) -> None:
    """List the presets, save one or remove one."""
    if save is not None and remove is not None:
        raise InputError("Give --save or --remove, not both.")

    async def work() -> None:
        async with _opened(camera, dry_run=dry_run) as opened:
            if save is not None:
                await opened.save_preset(save)
            if remove is not None:
                await opened.remove_preset(remove)
            found = await opened.presets()
        if as_json:
            put_json([{"name": preset.name, "description": preset.description} for preset in found])
        else:
            for preset in found:
                put(f"{preset.name}  {preset.description}".rstrip())

    run_async(work)


def watch(
    camera: CameraSpecArgument,
    folder: Annotated[Path | None, typer.Option("--out", help="Folder that keeps the pictures (default: none).")] = None,
    rate: Annotated[float, typer.Option("--rate", help="Pictures per second.")] = 1.0,
    count: Annotated[int, typer.Option("--count", min=0, help="Number of pictures; 0 for until Ctrl-C.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Follow the live picture: print time and pose of each frame, and keep the frames if a folder is given."""
    if not (math.isfinite(rate) and 0 < rate <= 60):
        raise InputError(f"--rate is above 0 and at most 60 pictures per second, got {rate:g}.")

    async def work() -> None:
        async with _opened(camera, realtime=True) as opened, aclosing(opened.frames(rate_hz=rate)) as stream:
            number = 0
            async for frame in stream:
                number += 1
                where: dict[str, Any] = {"number": number, "time_s": round(frame.time_s, 3), **frame.pose.as_dict()}
                if folder is not None:
                    where["file"] = str(path := folder / f"{number:06d}.jpg")
                    _write_picture(frame, path)
                put_json(where) if as_json else put(f"{where['time_s']:9.3f} s  {_pose_text(where)}")
                sys.stdout.flush()
                if number == count:
                    break

    run_async(work)


def password(camera: CameraSpecArgument) -> None:
    """Store the password of a camera's account in the operating system's keyring."""
    from scope_ptz.factory.cameras import parse_camera
    from scope_ptz.factory.passwords import account_of, store_password

    spec = parse_camera(camera)
    account = account_of(spec)
    entered = getpass.getpass(f"Password for {account}: ") if sys.stdin.isatty() else sys.stdin.readline().rstrip("\n")
    store_password(spec, entered)
    put(f"Stored the password for {account} in the keyring.")


@asynccontextmanager
async def _opened(spec: str, *, dry_run: bool = False, realtime: bool = False) -> AsyncIterator[Camera]:
    """Open a camera for one command, and close it afterwards."""
    from scope_ptz.camera.control import user_name
    from scope_ptz.camera.guard.dry_run import DryRunCamera
    from scope_ptz.factory.cameras import open_camera

    async with await open_camera(spec, realtime=realtime, actor=f"scope camera: {user_name()}") as opened:
        yield DryRunCamera(opened.camera, print_error) if dry_run else opened.camera


def _pose_text(pose: dict[str, Any]) -> str:
    return f"pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}x"


def _write_picture(frame: Frame, path: Path) -> None:
    from PIL import Image

    if path.suffix.lower() not in (".jpg", ".jpeg", ".png"):
        raise InputError(f"A picture's file ends in .jpg or .png, got {path.name[:60]}.")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(frame.image).save(path, quality=92)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}.") from error

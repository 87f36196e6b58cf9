"""``scope camera snapshot|move|focus|iris|presets|watch|password``: control a camera manually."""

from __future__ import annotations

import getpass
import math
import sys
from contextlib import aclosing, asynccontextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer

from scope_ptz.cli.exit import print_error, put, put_json, run_async
from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import InputError, OutputError

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from scope_ptz.camera.base import Arrival, Camera, Frame
    from scope_ptz.camera.lens import FocusAction, IrisAction, LensState

CameraSpecArgument = Annotated[
    str, typer.Argument(metavar="CAMERA", help="Camera: a name in scope.yaml, axis://USER@HOST, onvif://USER@HOST, sim:SCENE, ...")
]
DryRunOption = Annotated[bool, typer.Option("--dry-run", help="Print what the camera would do, without doing it.")]
LensStep = Annotated[float, typer.Option("--step", help="Size of a step, as a fraction of the range.")]


def snapshot(
    camera: CameraSpecArgument,
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write (.jpg or .png).")] = Path("snapshot.jpg"),
    full: Annotated[bool, typer.Option("--full", help="Sweep the camera's whole range, and save one panorama.")] = False,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """Save a picture of the camera's current view, or a panorama of its whole range."""

    from scope_ptz.tools.sweep import sweep

    async def work() -> None:
        async with open_for_command(camera, dry_run=dry_run) as opened_camera:
            frame = await (sweep(opened_camera) if full else opened_camera.frame())
        if dry_run:
            put_json({"file": str(out), "dry_run": True}) if as_json else print_error(f"would write {out}")
            return
        _write_picture(frame, out)
        facts = {"file": str(out), "width": frame.width, "height": frame.height, **frame.pose.as_dict()}
        if as_json:
            put_json({**facts, "hfov_deg": round(frame.hfov_deg, 2)})
        else:
            put(f"{out}: {frame.width}x{frame.height}, {pose_text(facts)}, {frame.hfov_deg:.1f} degrees wide")

    run_async(work)


def move(
    camera: CameraSpecArgument,
    pan: Annotated[float | None, typer.Option("--pan", help="Absolute pan in degrees.")] = None,
    tilt: Annotated[float | None, typer.Option("--tilt", help="Absolute tilt in degrees.")] = None,
    zoom: Annotated[float | None, typer.Option("--zoom", help="Absolute magnification.")] = None,
    by_pan: Annotated[float, typer.Option("--by-pan", help="Degrees to turn right; negative turns left.")] = 0.0,
    by_tilt: Annotated[float, typer.Option("--by-tilt", help="Degrees to turn up; negative turns down.")] = 0.0,
    centre: Annotated[
        str | None,
        typer.Option(
            "--centre",
            metavar="X,Y",
            help="Point of the picture to centre, as fractions of width and height from the top left, such as 0.7,0.4.",
        ),
    ] = None,
    zoom_by: Annotated[float, typer.Option("--zoom-by", help="Factor to zoom by, with --centre.")] = 1.0,
    preset: Annotated[str | None, typer.Option("--preset", help="Preset to go to.")] = None,
    home: Annotated[bool, typer.Option("--home", help="Go to the home position.")] = False,
    stop: Annotated[bool, typer.Option("--stop", help="Stop any motion.")] = False,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """Move the camera to a pose, by an angle, to a point in the picture, to a preset or home. Without options, print the pose."""
    values = [value for value in (pan, tilt, zoom, by_pan, by_tilt) if value is not None]
    if not all(math.isfinite(value) for value in values) or (zoom is not None and zoom <= 0):
        raise InputError("Angles must be finite numbers of degrees, and the magnification must be above 0.")
    changes_pose = pan is not None or tilt is not None or zoom is not None or by_pan != 0.0 or by_tilt != 0.0
    point = None if centre is None else _parse_point(centre)
    if sum((changes_pose, point is not None, preset is not None, home, stop)) > 1:
        raise InputError("Give only one of: a pose, --centre, --preset, --home, or --stop.")
    if zoom_by != 1.0 and point is None:
        raise InputError("--zoom-by requires --centre X,Y. Use --zoom for an absolute magnification.")

    async def carry_out(opened_camera: Camera) -> Arrival | None:
        if stop:
            await opened_camera.stop()
        elif point is not None:
            return await opened_camera.centre_on(*point, zoom_factor=zoom_by)
        elif preset is not None:
            return await opened_camera.go_to_preset(preset)
        elif home:
            return await opened_camera.go_home()
        elif changes_pose:
            start = await opened_camera.pose()
            requested = {"pan_deg": pan, "tilt_deg": tilt, "zoom": zoom}
            target = replace(start, **{name: value for name, value in requested.items() if value is not None})
            return await opened_camera.move(target.turned(by_pan, by_tilt))
        return None

    async def work() -> None:
        async with open_for_command(camera, dry_run=dry_run) as opened_camera:
            arrival = await carry_out(opened_camera)
            pose = (await opened_camera.pose() if arrival is None else arrival.pose).as_dict()
        clamped = () if arrival is None else arrival.clamped
        limited_by = "" if arrival is None else arrival.limited_by
        if as_json:
            put_json({**pose, "clamped": list(clamped), "limited_by": limited_by})
            return
        note = f"; limited by {limited_by}" if limited_by else f"; stopped by the {' and '.join(clamped)} limit" if clamped else ""
        put(pose_text(pose) + note)

    run_async(work)


def focus(
    camera: CameraSpecArgument,
    action: Annotated[
        str | None, typer.Argument(help="auto, manual (hold), once (focus and hold), near, or far. Without it, print the focus.")
    ] = None,
    step: LensStep = 0.05,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """Set the focus, or print it."""

    async def adjust(opened_camera: Camera) -> LensState:
        return await (opened_camera.lens() if action is None else opened_camera.set_focus(cast("FocusAction", action), step=step))

    _adjust_lens(camera, adjust, "focus", dry_run=dry_run, as_json=as_json)


def iris(
    camera: CameraSpecArgument,
    action: Annotated[str | None, typer.Argument(help="auto, manual (hold), open, or close. Without it, print the iris.")] = None,
    step: LensStep = 0.05,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """Set the iris, or print it."""

    async def adjust(opened_camera: Camera) -> LensState:
        return await (opened_camera.lens() if action is None else opened_camera.set_iris(cast("IrisAction", action), step=step))

    _adjust_lens(camera, adjust, "iris", dry_run=dry_run, as_json=as_json)


def _adjust_lens(
    spec: str, adjust: Callable[[Camera], Awaitable[LensState]], setting: str, *, dry_run: bool, as_json: bool
) -> None:
    """Adjust a camera's lens, and print the state of one setting."""

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


def presets(
    camera: CameraSpecArgument,
    save: Annotated[str | None, typer.Option("--save", metavar="NAME", help="Save the current pose under this name.")] = None,
    remove: Annotated[str | None, typer.Option("--remove", metavar="NAME", help="Remove a preset.")] = None,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> None:
    """List the presets, save the current pose as a preset, or remove a preset."""
    if save is not None and remove is not None:
        raise InputError("Give either --save or --remove, not both.")

    async def work() -> None:
        async with open_for_command(camera, dry_run=dry_run) as opened_camera:
            if save is not None:
                await opened_camera.save_preset(save)
            if remove is not None:
                await opened_camera.remove_preset(remove)
            current_presets = await opened_camera.presets()
        if as_json:
            put_json([{"name": preset.name, "description": preset.description} for preset in current_presets])
        else:
            for preset in current_presets:
                put(f"{preset.name}  {preset.description}".rstrip())

    run_async(work)


def watch(
    camera: CameraSpecArgument,
    folder: Annotated[
        Path | None, typer.Option("--out", help="Folder in which to save the pictures (default: they are not saved).")
    ] = None,
    rate: Annotated[float, typer.Option("--rate", help="Pictures per second.")] = 1.0,
    count: Annotated[int, typer.Option("--count", min=0, help="Number of pictures; 0 continues until Ctrl-C.")] = 0,
    as_json: JsonOption = False,
) -> None:
    """Watch the live video: print the time and pose of each frame, and save the frames if --out is given."""
    if not (math.isfinite(rate) and 0 < rate <= 60):
        raise InputError(f"--rate must be above 0 and at most 60 pictures per second; got {rate:g}.")

    async def work() -> None:
        async with open_for_command(camera, realtime=True) as opened_camera, aclosing(opened_camera.frames(rate_hz=rate)) as stream:
            number = 0
            async for frame in stream:
                number += 1
                facts: dict[str, Any] = {"number": number, "time_s": round(frame.time_s, 3), **frame.pose.as_dict()}
                if folder is not None:
                    facts["file"] = str(path := folder / f"{number:06d}.jpg")
                    _write_picture(frame, path)
                put_json(facts) if as_json else put(f"{facts['time_s']:9.3f} s  {pose_text(facts)}")
                sys.stdout.flush()
                if number == count:
                    break

    run_async(work)


def password(camera: CameraSpecArgument) -> None:
    """Store the password of a camera's account in the operating system's keyring."""
    from scope_ptz.factory.cameras import parse_camera
    from scope_ptz.factory.cameras.passwords import camera_account, store_password

    spec = parse_camera(camera)
    account = camera_account(spec)
    secret = getpass.getpass(f"Password for {account}: ") if sys.stdin.isatty() else sys.stdin.readline().rstrip("\n")
    store_password(spec, secret)
    put(f"Stored the password for {account} in the keyring.")


@asynccontextmanager
async def open_for_command(spec: str, *, dry_run: bool = False, realtime: bool = False) -> AsyncIterator[Camera]:
    """Open a camera for a single command, and close it afterwards."""
    from scope_ptz.camera.control import user_name
    from scope_ptz.camera.guard.dry_run import DryRunCamera
    from scope_ptz.factory.cameras import open_camera

    async with await open_camera(spec, realtime=realtime, actor=f"scope camera: {user_name()}") as opened:
        yield DryRunCamera(opened.camera, print_error) if dry_run else opened.camera


def _parse_point(text: str) -> tuple[float, float]:
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--centre must be two numbers from 0 to 1, such as 0.7,0.4; got {text[:40]!r}.") from None
    return x, y


def pose_text(pose: dict[str, Any]) -> str:
    """Format a pose as text, such as ``pan 20, tilt -5, zoom 2x``."""
    return f"pan {pose['pan_deg']:g}, tilt {pose['tilt_deg']:g}, zoom {pose['zoom']:g}x"


def _write_picture(frame: Frame, path: Path) -> None:
    from PIL import Image

    if path.suffix.lower() not in (".jpg", ".jpeg", ".png"):
        raise InputError(f"The name of a picture file must end in .jpg or .png; got '{path.name[:60]}'.")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(frame.image).save(path, quality=92)
    except OSError as error:
        raise OutputError(f"{path} cannot be written: {error.strerror or error}.") from error

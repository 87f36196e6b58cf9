"""``scope camera discover|probe|calibrate``: find cameras, and find out what they do."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.camera.by_hand import CameraSpecArgument
from scope_ptz.cli.exit import FAILED, print_error, put, put_json, run_async
from scope_ptz.cli.options import JsonOption

if TYPE_CHECKING:
    from pathlib import Path

    from scope_ptz.camera.measuring.profile import CalibrationRecord, ProbeRecord


def discover(
    interface: Annotated[
        list[str] | None,
        typer.Option("--interface", metavar="ADDRESS", help="IPv4 address of an interface to ask at (default: all; repeatable)."),
    ] = None,
    wait: Annotated[float, typer.Option("--wait", min=0.1, max=60.0, help="Seconds to wait for answers.")] = 3.0,
    as_json: JsonOption = False,
) -> None:
    """Find ONVIF cameras on the local networks and on this machine. No password is asked for or sent."""
    from scope_ptz.camera.onvif.discovery import FoundDevice, discover

    found: list[FoundDevice] = []

    async def work() -> None:
        found.extend(await discover(interface or (), wait_s=wait))

    run_async(work)
    if as_json:
        put_json([{"address": each.address, "name": each.name, "model": each.model, "spec": each.spec} for each in found])
    elif found:
        widths = [max(len(getattr(each, column)) for each in found) for column in ("address", "model", "name")]
        for each in found:
            columns = zip((each.address, each.model, each.name), widths, strict=True)
            put("  ".join(text.ljust(width) for text, width in columns) + f"  {each.spec}")
    else:
        put("No camera answered. Check that ONVIF discovery is on in the camera, and name its network with --interface.")


def probe(
    camera: CameraSpecArgument,
    report: Annotated[bool, typer.Option("--report", help="Print a text for the table of tested devices.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Find out what a camera can do, and store it in its profile. The camera does not move."""
    from scope_ptz.factory.camera_profiles import probe_camera

    done: list[tuple[ProbeRecord, Path]] = []

    async def work() -> None:
        done.append(await probe_camera(camera))

    run_async(work)
    record, file = done[0]
    if as_json:
        put_json(record.model_dump(mode="json"))
        return
    for line in _probe_lines(record, with_presets=not report):
        put(line)
    if not report:
        put(f"Stored in {file}")


def calibrate(
    camera: CameraSpecArgument,
    zooms: Annotated[int, typer.Option("--zooms", min=2, max=20, help="Number of zooms to measure the field of view at.")] = 6,
    as_json: JsonOption = False,
) -> int:
    """Measure a camera from its own pictures: signs and response of pan and tilt, field of view by zoom, latency, settling.

    The camera moves for a minute or two. The exit code is 1 if its pictures contradict what it states.
    """
    from scope_ptz.factory.camera_profiles import calibrate_camera

    done: list[tuple[CalibrationRecord, Path]] = []
    shown = sys.stderr.isatty() and not as_json

    async def work() -> None:
        done.append(await calibrate_camera(camera, zooms=zooms, progress=print_error if shown else lambda _: None))

    run_async(work)
    record, file = done[0]
    if as_json:
        put_json(record.model_dump(mode="json"))
    else:
        for line in _calibration_lines(record):
            put(line)
        put(f"Stored in {file}")
    for sentence in record.contradictions:
        print_error(sentence)
    return FAILED if record.contradictions else 0


def _probe_lines(record: ProbeRecord, *, with_presets: bool) -> list[str]:
    """Return what a probe found. It holds neither an address nor an account; presets may name places, so a report counts them."""
    pan = "endless" if record.pan_endless else "{:.1f} to {:.1f} degrees".format(*record.pan_range_deg)
    table = ", ".join(f"{zoom:.2f}x {hfov:.1f}" for zoom, hfov in record.zoom_table)
    offers = {"drive": record.drives, "presets can be edited": record.edits_presets, "focus": record.focus, "iris": record.iris}
    can = [name for name, offered in offers.items() if offered]
    presets = f"{len(record.presets)}" + (f": {', '.join(record.presets)}" if with_presets and record.presets else "")
    return [
        f"Model: {record.model}",
        f"Driver: {record.driver}",
        f"Pan: {pan}",
        "Tilt: {:.1f} to {:.1f} degrees".format(*record.tilt_range_deg),
        "Zoom: {:.2f}x to {:.2f}x".format(*record.zoom_range),
        f"Horizontal field of view in degrees: {table}",
        f"Picture: {record.frame_width}x{record.frame_height}, {1000 * record.snapshot_s:.0f} ms in the median",
        f"Can: {', '.join(can) or 'move and take pictures only'}",
        f"Presets: {presets}",
        *([f"Only assumed until it is calibrated: {', '.join(record.assumed)}"] if record.assumed else []),
    ]


def _calibration_lines(record: CalibrationRecord) -> list[str]:
    signs = [
        f"{name}: {words[0] if scale > 0 else words[1]}, {abs(scale):.3f} degrees for each degree"
        for name, scale, words in (
            ("Pan", record.pan_scale, ("positive is right", "INVERTED, positive is left")),
            ("Tilt", record.tilt_scale, ("positive is up", "INVERTED, positive is down")),
        )
    ]
    return [
        *signs,
        f"Horizon: where the camera states a tilt of 0, it looks {record.tilt_offset_deg:+.1f} degrees from it",
        "Zoom     measured  stated (horizontal field of view in degrees)",
        *(f"{each.zoom:6.2f}x {each.measured_deg:9.2f} {each.stated_deg:7.2f}" for each in record.fields),
        f"Picture: {1000 * record.snapshot_s:.0f} ms; move of 20 degrees: {record.move_s:.2f} s; "
        f"settled {record.settling_s:.2f} s after arrival",
    ]

"""``scope camera discover|probe|calibrate``: find cameras, and measure their properties."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.camera.manual_control import CameraSpecArgument, DryRunOption, pose_text
from scope_ptz.cli.exit import FAILED, print_error, put, put_json, run_async
from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import OutputError

if TYPE_CHECKING:
    from scope_ptz.camera.measurement.calibration_plan import CalibrationPlan
    from scope_ptz.camera.measurement.profile import CalibrationRecord, ProbeRecord


def discover(
    interface: Annotated[
        list[str] | None,
        typer.Option("--interface", metavar="ADDRESS", help="IPv4 address of an interface to search (default: all; repeatable)."),
    ] = None,
    wait: Annotated[float, typer.Option("--wait", min=0.1, max=60.0, help="Seconds to wait for answers.")] = 3.0,
    as_json: JsonOption = False,
) -> None:
    """Find ONVIF cameras on the local networks and on this machine. No password is needed or sent."""
    from scope_ptz.camera.onvif.discovery import DiscoveredDevice, discover

    devices: list[DiscoveredDevice] = []

    async def work() -> None:
        devices.extend(await discover(interface or (), wait_s=wait))

    run_async(work)
    if as_json:
        put_json(
            [{"address": device.address, "name": device.name, "model": device.model, "spec": device.spec} for device in devices]
        )
    elif devices:
        widths = [max(len(getattr(device, column)) for device in devices) for column in ("address", "model", "name")]
        for device in devices:
            columns = zip((device.address, device.model, device.name), widths, strict=True)
            put("  ".join(text.ljust(width) for text, width in columns) + f"  {device.spec}")
    else:
        put("No camera answered. Enable ONVIF discovery in the camera, or select its network with --interface.")


def probe(
    camera: CameraSpecArgument,
    report: Annotated[
        bool, typer.Option("--report", help="Write a report for the table of tested devices, without addresses or serial numbers.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="File to write the report to (default: camera-report-MODEL.md).")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Read a camera's capabilities and store them in its profile. The camera does not move."""
    from scope_ptz.factory.cameras.profiles import probe_camera

    results: list[tuple[ProbeRecord, Path]] = []

    async def work() -> None:
        results.append(await probe_camera(camera))

    run_async(work)
    record, file = results[0]
    report_path = _write_report(record, camera, out) if report else None
    if as_json:
        put_json(record.model_dump(mode="json"))
        return
    for line in _probe_lines(record):
        put(line)
    put(f"Stored in {file}")
    if report_path is not None:
        put(f"Report: {report_path}. It contains no addresses, accounts or serial numbers.")


def calibrate(
    camera: CameraSpecArgument,
    zoom_count: Annotated[int, typer.Option("--zooms", min=2, max=20, help="Number of zoom levels to measure.")] = 6,
    dry_run: DryRunOption = False,
    as_json: JsonOption = False,
) -> int:
    """Measure a camera from its pictures: pan and tilt direction and scale, field of view at each zoom, latency and settling time.

    The camera moves for a minute or two. The exit code is 1 if its pictures contradict the values that it reports.
    """
    from scope_ptz.factory.cameras.profiles import calibrate_camera

    if dry_run:
        _print_plan(camera, zoom_count, as_json=as_json)
        return 0
    results: list[tuple[CalibrationRecord, Path]] = []
    show_progress = sys.stderr.isatty() and not as_json

    async def work() -> None:
        results.append(await calibrate_camera(camera, zooms=zoom_count, progress=print_error if show_progress else lambda _: None))

    run_async(work)
    record, file = results[0]
    if as_json:
        put_json(record.model_dump(mode="json"))
    else:
        for line in _calibration_lines(record):
            put(line)
        put(f"Stored in {file}")
    for sentence in record.contradictions:
        print_error(sentence)
    return FAILED if record.contradictions else 0


def _print_plan(camera: str, zoom_count: int, *, as_json: bool) -> None:
    from scope_ptz.factory.cameras.profiles import plan_camera_calibration

    plans: list[CalibrationPlan] = []

    async def work() -> None:
        plans.append(await plan_camera_calibration(camera, zooms=zoom_count))

    run_async(work)
    plan, start = plans[0], plans[0].base.as_dict()
    if as_json:
        put_json({**asdict(plan), "base": start})
        return
    vertical = f"{abs(plan.tilt_deg):.0f} degrees {'up' if plan.tilt_deg > 0 else 'down'}"
    put(f"A calibration of {plan.camera} would move it to {pose_text(start)}. From there, it would")
    put(f"- turn by up to {plan.pan_deg:.0f} degrees to each side, and {vertical},")
    put(f"- zoom to {', '.join(f'{zoom:.2f}x' for zoom in plan.zooms)},")
    put("- and return to its initial pose. If the view shows too little detail, it would try up to three other directions.")
    put("Dry run: the camera did not move, and nothing was stored.")


def _write_report(record: ProbeRecord, camera: str, out: Path | None) -> Path:
    """Write a report about a camera, including its stored measurements.

    Raises:
        OutputError: The file cannot be written.
    """
    from scope_ptz.camera.measurement.report import report_name, report_text
    from scope_ptz.factory.cameras.profiles import stored_calibration

    path = out or Path(report_name(record))
    try:
        path.write_text(report_text(record, stored_calibration(camera)), encoding="utf-8")
    except OSError as error:
        raise OutputError(f"The report {path} cannot be written: {error.strerror or error}. Choose another file.") from error
    return path


def _probe_lines(record: ProbeRecord) -> list[str]:
    """Return the results of a probe as lines of text."""
    pan = "endless" if record.pan_endless else "{:.1f} to {:.1f} degrees".format(*record.pan_range_deg)
    zoom_table = ", ".join(f"{zoom:.2f}x {hfov:.1f}" for zoom, hfov in record.zoom_table)
    offered_capabilities = {
        "drive": record.drives,
        "edit presets": record.edits_presets,
        f"focus ({', '.join(record.focus_actions)})": record.focus,
        f"iris ({', '.join(record.iris_actions)})": record.iris,
    }
    capabilities = [name for name, offered in offered_capabilities.items() if offered]
    presets = f"{len(record.presets)}" + (f": {', '.join(record.presets)}" if record.presets else "")
    return [
        f"Model: {record.model}",
        f"Firmware: {record.firmware or 'not reported'}",
        f"Driver: {record.driver}",
        f"Pan: {pan}",
        "Tilt: {:.1f} to {:.1f} degrees".format(*record.tilt_range_deg),
        "Zoom: {:.2f}x to {:.2f}x".format(*record.zoom_range),
        f"Horizontal field of view in degrees: {zoom_table}",
        f"Picture: {record.frame_width}x{record.frame_height}, {1000 * record.snapshot_s:.0f} ms (median)",
        f"Capabilities: {', '.join(capabilities) or 'only moves and pictures'}",
        f"Presets: {presets}",
        *([f"Assumed until the camera is calibrated: {', '.join(record.assumed)}"] if record.assumed else []),
    ]


def _calibration_lines(record: CalibrationRecord) -> list[str]:
    axis_lines = [
        f"{name}: {directions[0] if scale > 0 else directions[1]}, {abs(scale):.3f} degrees per reported degree"
        for name, scale, directions in (
            ("Pan", record.pan_scale, ("positive is right", "INVERTED, positive is left")),
            ("Tilt", record.tilt_scale, ("positive is up", "INVERTED, positive is down")),
        )
    ]
    horizon_deg = round(record.tilt_offset_deg, 1) + 0.0  # no negative zero
    return [
        *axis_lines,
        f"Horizon: at a reported tilt of 0, the camera points {horizon_deg:+.1f} degrees from the horizon",
        "Zoom     measured reported (horizontal field of view in degrees)",
        *(f"{row.zoom:6.2f}x {row.measured_deg:9.2f} {row.stated_deg:8.2f}" for row in record.fields),
        f"Picture: {1000 * record.snapshot_s:.0f} ms; 20-degree move: {record.move_s:.2f} s; "
        f"settled {record.settling_s:.2f} s after arrival",
    ]

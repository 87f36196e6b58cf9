"""Quick checks that a plug-in can be loaded and fulfils its contract for one small request."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Literal

import anyio
import numpy as np

from scope_ptz.camera.base import Frame
from scope_ptz.entry_points import call_factory, one_line
from scope_ptz.errors import ConfigError, PerceptionError
from scope_ptz.factory.plugins import Kind, Plugin
from scope_ptz.geometry import Limits, Perspective, Pose

CHECK_TIMEOUT_S = 20.0
"""Timeout in seconds for checking a plug-in."""

Verdict = Literal["ok", "partly", "failed"]


@dataclass(frozen=True, slots=True)
class PluginCheck:
    """The result of checking a plug-in.

    Attributes:
        plugin: The plug-in.
        verdict: "partly" means that the plug-in was loaded but could not be tested, for example because no address is known.
        detail: A one-line explanation for the user.
    """

    plugin: Plugin
    verdict: Verdict
    detail: str


async def check_plugin(plugin: Plugin) -> PluginCheck:
    """Load a plug-in and test it with one request. Failures are reported in the result instead of being raised.

    A camera is opened only if its factory has an attribute ``example``, an address that can be opened without hardware.
    """
    if plugin.problem:
        return PluginCheck(plugin, "failed", plugin.problem)
    try:
        plugin.entry.load()
    except ConfigError as error:
        return PluginCheck(plugin, "failed", str(error))
    try:
        with anyio.fail_after(CHECK_TIMEOUT_S):
            return PluginCheck(plugin, *await _CHECKS[plugin.kind](plugin))
    except ConfigError as error:
        return PluginCheck(plugin, "partly", f"it was loaded but not tested: {error}")
    except TimeoutError:
        return PluginCheck(plugin, "failed", f"it did not respond within {CHECK_TIMEOUT_S:g} s")
    except _BrokenContractError as error:
        return PluginCheck(plugin, "failed", str(error))
    except Exception as error:  # code from another package can raise anything
        return PluginCheck(plugin, "failed", one_line(error))


async def _check_camera(plugin: Plugin) -> tuple[Verdict, str]:
    from scope_ptz.factory.cameras import open_camera

    example = getattr(plugin.entry.load(), "example", None)
    if example is None:
        return "partly", "it was loaded but not opened: its factory has no attribute `example` with an address"
    async with await open_camera(f"{plugin.name}:{example}") as opened:
        camera, info = opened.camera, opened.camera.info
        _expect(bool(info.name), "the camera has no name")
        limits = info.limits
        _expect(
            limits.min_pan_deg < limits.max_pan_deg and limits.min_tilt_deg < limits.max_tilt_deg,
            "its pan or tilt limits are in the wrong order",
        )
        _expect(0 < limits.min_zoom <= limits.max_zoom, "its zoom limits are in the wrong order or not positive")
        pose = await camera.pose()
        _expect(not limits.clamp(pose)[1], f"its first pose {pose} is outside its own limits")
        frame = await camera.frame()
        _expect(
            (frame.width, frame.height) == (info.frame_width, info.frame_height), "the frame size differs from the size in its info"
        )
        _expect(isinstance(await camera.presets(), list), "presets() does not return a list")
        return "ok", f"{info.name}, {frame.width} x {frame.height}"


async def _check_planner(plugin: Plugin) -> tuple[Verdict, str]:
    from scope_ptz.planner.base import Briefing, CallTools, Finish, Planner, State
    from scope_ptz.planner.spec import PlannerSpec
    from scope_ptz.tools.registry import schemas

    planner = call_factory(plugin.entry, Planner, PlannerSpec(name=plugin.name))  # type: ignore[type-abstract]
    try:
        briefing = Briefing(presets=("home",), pose=Pose(), limits=Limits())
        state = State(instruction="Pan right 20 degrees.", briefing=briefing, tools=tuple(schemas()))
        decision = await planner.step(state)
    finally:
        await planner.close()
    _expect(isinstance(decision, CallTools | Finish), f"step() returned a {type(decision).__name__}, which is not a decision")
    return "ok", f"its first decision is '{decision.kind}'"


async def _check_perception(plugin: Plugin) -> tuple[Verdict, str]:
    from scope_ptz.perception.backends.spec import BackendSpec
    from scope_ptz.perception.base import ALL_SKILLS, Answer, Caption, Detections, Perception, Points

    spec = BackendSpec(name=plugin.name, backend=plugin.name)
    perception = call_factory(plugin.entry, Perception, spec)  # type: ignore[type-abstract]
    frame = _grey_frame()
    requests: dict[str, tuple[Callable[[], Awaitable[object]], type]] = {
        "detect": (lambda: perception.detect(frame, "cone"), Detections),
        "point": (lambda: perception.point(frame, "cone"), Points),
        "query": (lambda: perception.query(frame, "Is there a cone?"), Answer),
        "caption": (lambda: perception.caption(frame), Caption),
    }
    try:
        unknown = sorted(set(perception.skills) - ALL_SKILLS)
        _expect(not unknown, f"it declares unknown skills: {', '.join(unknown)}")
        _expect(bool(perception.skills), "it declares no skills")
        skill = next(name for name in requests if name in perception.skills)
        request, result_type = requests[skill]
        try:
            result = await request()
        except PerceptionError as error:
            return "partly", f"it was loaded, but {skill}() failed on a grey frame: {one_line(error)}"
    finally:
        await perception.close()
    _expect(isinstance(result, result_type), f"{skill}() returned a {type(result).__name__} instead of a {result_type.__name__}")
    return "ok", f"skills: {', '.join(name for name in requests if name in perception.skills)}"


_CHECKS: dict[Kind, Callable[[Plugin], Awaitable[tuple[Verdict, str]]]] = {
    "camera": _check_camera,
    "planner": _check_planner,
    "perception": _check_perception,
}


def _grey_frame() -> Frame:
    view = Perspective(0.0, 0.0, 60.0, 64, 36)
    return Frame(np.full((36, 64, 3), 128, np.uint8), Pose(), view.hfov_deg, 0.0, view)


def _expect(condition: bool, problem: str) -> None:
    if not condition:
        raise _BrokenContractError(problem)


class _BrokenContractError(Exception):
    """A plug-in violates its contract."""

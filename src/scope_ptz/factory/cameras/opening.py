"""Open cameras, with their clocks and ground truth."""

from __future__ import annotations

import inspect
from collections.abc import Awaitable, Callable
from functools import partial
from types import TracebackType
from typing import TYPE_CHECKING

from scope_ptz.builtin_names import BLENDER_WINDOW
from scope_ptz.camera.base import Camera
from scope_ptz.camera.clocks import Clock
from scope_ptz.camera.control import user_name
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.entry_points import CAMERAS, call_factory, expect_product, find, one_line
from scope_ptz.errors import CameraError, InputError, ScopeError
from scope_ptz.factory.cameras.network import NETWORK_SCHEMES
from scope_ptz.factory.cameras.parsing import frame_size, parse_camera, unknown_scheme

if TYPE_CHECKING:
    from scope_ptz.camera.blender_addon.connection import AddOnSlot
    from scope_ptz.perception.ground_truth.served import ServedTruth
    from scope_ptz.simulator.pack import Scene


class OpenCamera:
    """An open camera. Close it with ``aclose``, or use it as an async context manager.

    Attributes:
        spec: The spec from which the camera was opened.
        camera: The camera.
        scene: The scene that the camera shows, with the ground truth for its frames if there is any; None for other cameras.
        served_truth: A function that connects to a virtual camera's ground truth; None for other cameras, and for a camera whose
            rules in ``scope.yaml`` change its pictures or poses.
    """

    def __init__(
        self,
        spec: CameraSpec,
        camera: Camera,
        scene: Scene | None = None,
        release: Callable[[], Awaitable[None]] | None = None,
        served_truth: Callable[[], ServedTruth] | None = None,
    ) -> None:
        self.spec, self.camera, self.scene, self.served_truth = spec, camera, scene, served_truth
        self._release = release

    @property
    def clock(self) -> Clock:
        """The camera's clock."""
        return self.camera.clock

    @property
    def has_truth(self) -> bool:
        """Whether there is ground truth for the camera's frames."""
        return self.scene is not None and self.scene.file.captured is None

    @property
    def scenes(self) -> Callable[[str], Scene] | None:
        """A function that returns a scene by name, for ``make_perception``; None for a camera without a scene."""
        return None if self.scene is None else {self.scene.name: self.scene}.__getitem__

    def record_instruction(self, instruction: str) -> None:
        """Record an instruction in the camera's audit log, if it has one."""
        from scope_ptz.camera.guard.guarded_camera import GuardedCamera

        if isinstance(self.camera, GuardedCamera):
            self.camera.record_instruction(instruction)

    async def aclose(self) -> None:
        """Close the camera and release its resources, such as a worker process."""
        release, self._release = self._release, None
        try:
            await self.camera.close()
        finally:
            if release is not None:
                await release()

    async def __aenter__(self) -> OpenCamera:
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        await self.aclose()


async def open_camera(
    spec: CameraSpec | str,
    *,
    viewpoint: str | None = None,
    preset: str | None = None,
    time_s: float | None = None,
    realtime: bool = False,
    actor: str | None = None,
    for_measurement: bool = False,
    dry_run: Callable[[str], None] | None = None,
    add_on: AddOnSlot | None = None,
) -> OpenCamera:
    """Open a camera. A camera named in ``scope.yaml`` follows the rules in that file.

    Args:
        spec: A parsed spec, or its text.
        viewpoint: The camera's viewpoint in the scene; by default, that of the home preset.
        preset: The preset to start at. It determines the viewpoint, so it cannot be combined with ``viewpoint``.
        time_s: Initial scene time in seconds; by default, the scene's own start time.
        realtime: Whether scene time follows the wall clock, so that people can watch. If not, moves take no wall-clock time.
        actor: Name of the holder of control, which is recorded in the audit log and shown to other programs that request control;
            by default, the operating system's user name.
        for_measurement: Whether the camera is opened to be probed or calibrated. If so, stored measurements are ignored, and the
            driver may assume values that are not known yet.
        dry_run: If given, commands are not carried out; instead, this function is called with a description of each command. A
            simulated camera still starts at its preset.
        add_on: The slot for the connection to a Blender add-on, for ``blender-window``; None outside a server.

    Returns:
        The open camera, which the caller must close.

    Raises:
        InputError: The spec, the viewpoint, the preset or the combination of options is invalid.
        PackError: A scene's files are damaged.
        CameraError: The camera failed or did not respond.
        BlenderError: Blender cannot be started, or cannot open the scene or the file.
    """
    if isinstance(spec, str):
        spec = parse_camera(spec)
    if viewpoint and preset:
        raise InputError("Use either --viewpoint or --preset, not both: a preset determines the viewpoint.")
    if spec.scheme == "sim":
        from anyio import to_thread

        # Open the scene in a thread, so that a server can continue to deliver pictures.
        opened = await to_thread.run_sync(partial(_open_simulated, spec, viewpoint, time_s, realtime=realtime))
    elif spec.scheme == "blender":
        from scope_ptz.factory.cameras.blender import open_live_blender

        live = await open_live_blender(spec, viewpoint=viewpoint, time_s=time_s, realtime=realtime)
        opened = OpenCamera(spec, live.camera, live.scene, live.release)
    elif spec.scheme == BLENDER_WINDOW:
        _reject_scene_options(spec, viewpoint, time_s, "the scene that is open in Blender")
        opened = _open_blender_window(spec, add_on)
    elif spec.scheme in NETWORK_SCHEMES:
        opened = await _open_network(spec, viewpoint, time_s, actor, for_measurement=for_measurement)
    else:
        opened = await _open_plugin(spec, viewpoint, time_s)
    try:
        if spec.name:
            from scope_ptz.factory.cameras.named_cameras import apply_rules

            guarded = apply_rules(opened.camera, spec.name, actor=actor or f"scope: {user_name()}")
            if guarded is not opened.camera:
                opened.camera, opened.served_truth = guarded, None
        if preset and (dry_run is None or opened.camera.info.simulated):
            await opened.camera.go_to_preset(preset)
        if dry_run is not None:
            from scope_ptz.camera.guard.dry_run import DryRunCamera

            simulated = opened.camera.info.simulated
            opened.camera = DryRunCamera(opened.camera, dry_run)
            if preset and not simulated:
                await opened.camera.go_to_preset(preset)
    except BaseException:
        await opened.aclose()
        raise
    return opened


def _open_simulated(spec: CameraSpec, viewpoint: str | None, time_s: float | None, *, realtime: bool) -> OpenCamera:
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.factory.scenes import open_scene
    from scope_ptz.simulator.clock import SceneClock

    scene = open_scene(spec.address, cache_pictures=True)
    clock = SceneClock(scene.file.start_s if time_s is None else time_s, realtime=realtime)
    width, height = frame_size(spec)
    return OpenCamera(spec, SimulatedCamera(scene, viewpoint=viewpoint, clock=clock, width=width, height=height), scene)


def _open_blender_window(spec: CameraSpec, add_on: AddOnSlot | None) -> OpenCamera:
    from scope_ptz.camera.blender_addon.camera import BlenderWindowCamera

    if add_on is None:
        raise InputError(
            f"The camera {BLENDER_WINDOW} is available only on a server to which Blender's add-on connects. Start a server with "
            f"`scope serve --camera {BLENDER_WINDOW}`."
        )
    return OpenCamera(spec, BlenderWindowCamera(add_on))


async def _open_network(
    spec: CameraSpec, viewpoint: str | None, time_s: float | None, actor: str | None, *, for_measurement: bool
) -> OpenCamera:
    from scope_ptz.factory.cameras.network import open_network_camera

    _reject_scene_options(spec, viewpoint, time_s, "a camera on the network")
    connected = await open_network_camera(spec, actor=actor or f"scope: {user_name()}", for_measurement=for_measurement)
    return OpenCamera(spec, connected.camera, None, connected.release, connected.served_truth)


def _reject_scene_options(spec: CameraSpec, viewpoint: str | None, time_s: float | None, kind: str) -> None:
    if viewpoint is not None or time_s is not None:
        option = "--viewpoint" if viewpoint is not None else "--at"
        raise InputError(f"{option} requires a camera in a scene, but '{spec}' is {kind}. Remove the option.")


async def _open_plugin(spec: CameraSpec, viewpoint: str | None, time_s: float | None) -> OpenCamera:
    """Open a camera from an installed plug-in, whose factory may be a plain or an async function."""
    entry = find(CAMERAS, spec.scheme)
    if entry is None:
        raise InputError(unknown_scheme(spec.scheme, str(spec)))
    _reject_scene_options(spec, viewpoint, time_s, f"the camera of {entry.package}")
    product = call_factory(entry, object, spec)
    if inspect.isawaitable(product):
        try:
            product = await product
        except ScopeError:
            raise
        except Exception as error:  # code from another package can raise anything
            raise CameraError(f"The camera '{spec}' ({entry.package}) cannot be opened: {one_line(error)}.") from error
    return OpenCamera(spec, expect_product(entry, Camera, product))  # type: ignore[type-abstract]

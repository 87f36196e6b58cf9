"""The values that cameras return: camera information, frames, presets and arrivals."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from scope_ptz.camera.capabilities import NO_CAPABILITIES, Capabilities
from scope_ptz.camera.picture_aim import towards_point

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scope_ptz.geometry import Axis, Limits, Optics, Pose, Projection


@dataclass(frozen=True, slots=True)
class CameraInfo:
    """A camera's properties, which are known before it moves.

    Attributes:
        name: The camera's name, as recorded in traces.
        limits: Limits of pan, tilt and zoom.
        optics: The optics, which relate zoom to field of view.
        frame_width: Width of a frame in pixels.
        frame_height: Height of a frame in pixels.
        simulated: Whether the pictures are rendered rather than taken by a real camera.
        capabilities: The camera's optional capabilities.
        rendering: Version of the simulator's rendering; None for other cameras.
        assumed: Names of values that the driver assumes until they are measured, such as "field of view".
        firmware: Firmware version; empty if the device reports none.
        dry_run: Whether commands are only reported and not carried out, so that the view does not change.
    """

    name: str
    limits: Limits
    optics: Optics
    frame_width: int
    frame_height: int
    simulated: bool
    capabilities: Capabilities = NO_CAPABILITIES
    rendering: int | None = None
    assumed: tuple[str, ...] = ()
    firmware: str = ""
    dry_run: bool = False

    def towards(self, pose: Pose, x: float, y: float, zoom_factor: float = 1.0) -> Pose:
        """Return the pose that centres a point in the picture taken at ``pose``. The result may be beyond the limits.

        Args:
            pose: The current pose.
            x: Horizontal position of the point, from 0 (left edge) to 1 (right edge).
            y: Vertical position of the point, from 0 (top edge) to 1 (bottom edge).
            zoom_factor: Factor by which to change the focal length.

        Raises:
            InputError: The point is outside the picture, or the factor is not above 0.
        """
        return towards_point(self.optics, self.limits, (self.frame_width, self.frame_height), pose, x, y, zoom_factor)


@dataclass(frozen=True, slots=True)
class FrameOrigin:
    """The scene, viewpoint, pose and time from which a simulated frame was rendered.

    Only the simulator and ground-truth perception use it. Frames from real cameras have none.
    """

    scene: str
    viewpoint: str
    pose: Pose
    time_s: float


@dataclass(frozen=True, slots=True)
class Frame:
    """A picture with the geometry that maps its pixels to directions.

    Attributes:
        image: Read-only array of shape ``(H, W, 3)``, uint8, RGB.
        pose: The camera's pose at the time of exposure; for a stitched panorama, the pose at the start of the sweep.
        hfov_deg: Horizontal field of view in degrees.
        time_s: Time of exposure in seconds on the camera's clock.
        projection: The mapping between pixels and directions.
        origin: The origin of a simulated frame; None for real cameras.
    """

    image: NDArray[np.uint8]
    pose: Pose
    hfov_deg: float
    time_s: float
    projection: Projection
    origin: FrameOrigin | None = None

    def __post_init__(self) -> None:
        if self.image.ndim != 3 or self.image.shape[2] != 3 or self.image.dtype != "uint8":
            raise ValueError(f"the image of a frame must be an (H, W, 3) uint8 array; got {self.image.shape} {self.image.dtype}")
        self.image.flags.writeable = False

    @property
    def width(self) -> int:
        return int(self.image.shape[1])

    @property
    def height(self) -> int:
        return int(self.image.shape[0])

    def __repr__(self) -> str:
        pose = ", ".join(f"{name}={value:g}" for name, value in self.pose.as_dict().items())
        return f"<Frame {self.width}x{self.height}, {pose}, hfov_deg={self.hfov_deg:g}, time_s={self.time_s:g}>"

    def _repr_html_(self) -> str:
        """Return HTML for notebooks: the picture, with its pose and field of view in the caption."""
        from scope_ptz.camera.notebook import figure_html

        pose = self.pose.as_dict()
        pose_text = f"pan {pose['pan_deg']:+.1f}° · tilt {pose['tilt_deg']:+.1f}° · zoom {pose['zoom']:.1f}x"
        scene_text = f"{self.origin.scene} / {self.origin.viewpoint} · " if self.origin else ""
        return figure_html(self.image, f"{scene_text}{pose_text} · {self.hfov_deg:.0f}° wide · {self.time_s:.1f} s")


@dataclass(frozen=True, slots=True)
class PresetInfo:
    """A preset's name and its description, which may be empty.

    Attributes:
        viewpoint: The viewpoint in the simulated scene from which the preset looks; None for a camera with a single viewpoint.
        is_home: Whether the preset is known to be the camera's home.
    """

    name: str
    description: str = ""
    viewpoint: str | None = None
    is_home: bool = False


@dataclass(frozen=True, slots=True)
class Arrival:
    """The result of a move.

    Attributes:
        pose: The pose that the camera reached.
        clamped: The axes that stopped at a limit.
        limited_by: Anything else that stopped the camera early, as a noun phrase such as "the keep-out region 'window'"; empty if
            nothing did.
    """

    pose: Pose
    clamped: tuple[Axis, ...] = field(default=())
    limited_by: str = ""

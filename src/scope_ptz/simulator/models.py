"""The pack format: the contents of a scene folder and its viewpoint folders, as validated models.

Layout of a scene folder::

    scene.json                    SceneFile: instances, texts, presets, actors, absent objects
    <viewpoint>/manifest.json     Manifest: geometry of every layer, independent of the camera's optics, with checksums
    <viewpoint>/base.avif         equirectangular colour
    <viewpoint>/ids.webp          equirectangular instance IDs, 16 bit
    <viewpoint>/depth.webp        equirectangular distance, 16 bit, logarithmic
    <viewpoint>/tiles/NN.avif     perspective colour where more detail is needed, NN-ids.webp its instance IDs
    <viewpoint>/actors/ID.avif    sprites of a moving actor along its path (colour, alpha), ID-depth.webp their distances
    <viewpoint>/seen.png          captured scenes only: which parts of the panorama were seen

All angles are in camera coordinates (pan 0 is the viewpoint's ``pan0_bearing_deg``), all lengths in metres.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scope_ptz.geometry import AXIS_M5075_G, Limits, Optics, Perspective

FORMAT_VERSION = 1
"""Version of the pack format. It increases when older programs could misread a pack."""

INJECTED_FROM = 60000
"""First instance ID for objects that are injected at run time. A bake uses only smaller IDs."""

Number = Annotated[float, Field(allow_inf_nan=False)]
Vec3 = tuple[Number, Number, Number]
PanTilt = tuple[Number, Number]
Kebab = Annotated[str, Field(pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$")]
Attribute = str | bool | int | float


class Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class SceneInstance(Model):
    """One annotated object. ``box_min_m`` and ``box_max_m`` span its axis-aligned box in world coordinates.

    ``id`` identifies it in the scene file. ``number`` is its instance ID, the value of its pixels in the layers.
    """

    id: str
    number: int = Field(gt=0, lt=INJECTED_FROM)
    category: str
    name: str
    attributes: dict[str, Attribute] = {}
    parent: str | None = None
    box_min_m: Vec3
    box_max_m: Vec3


class SceneText(Model):
    """One readable text: a flat block of letters on an instance (``parent``), in world coordinates.

    ``right`` points along the line of text and ``up`` towards the tops of the letters. The normal is ``right x up``.
    """

    id: str
    text: str
    parent: str
    centre_m: Vec3
    right: Vec3
    up: Vec3
    width_m: Number = Field(gt=0)
    height_m: Number = Field(gt=0)
    cap_height_m: Number = Field(gt=0)


class ScenePreset(Model):
    name: Kebab
    viewpoint: Kebab
    pan_deg: Number
    tilt_deg: Number
    zoom: Number = Field(gt=0)
    description: str = ""


class SceneViewpoint(Model):
    name: Kebab
    position_m: Vec3
    pan0_bearing_deg: Number
    description: str = ""


class SceneActor(Model):
    """A moving object. ``waypoints`` are ``(t_s, x, y, z)``, joined by straight lines. The path repeats every ``period_s``.

    The actor is in the scene from the time of its first waypoint to that of its last. Path time begins at scene time ``delay_s``.
    """

    id: str
    number: int = Field(gt=0, lt=INJECTED_FROM)
    category: str
    name: str
    attributes: dict[str, Attribute] = {}
    waypoints: list[tuple[Number, Number, Number, Number]] = Field(min_length=2)
    period_s: Number = Field(gt=0)
    delay_s: Number = 0.0
    size_m: Vec3


class CapturedFrom(Model):
    """The camera from which a scene was captured. Captured scenes have pictures, but no ground truth.

    Attributes:
        camera: Name of the camera.
        captured_at: When the capture began (ISO 8601, UTC).
        pan_range_deg: Pan limits of the captured part.
        tilt_range_deg: Tilt limits of the captured part.
        zoom_range: Limits of the magnification.
        pan_endless: Whether pan has no stops.
        zoom_table: Rows of magnification and horizontal field of view in degrees, widest first.
        frame_width: Width of the camera's frames in pixels.
        frame_height: Height of the camera's frames in pixels.
        unseen_share: Fraction of the reachable part of the sphere that no frame shows or that the site's rules mask out.
    """

    camera: str
    captured_at: str
    pan_range_deg: tuple[Number, Number]
    tilt_range_deg: tuple[Number, Number]
    zoom_range: tuple[Number, Number]
    pan_endless: bool
    zoom_table: tuple[tuple[Number, Number], ...]
    frame_width: int = Field(gt=0)
    frame_height: int = Field(gt=0)
    unseen_share: Number = Field(ge=0, le=1)

    @model_validator(mode="after")
    def _has_optics(self) -> CapturedFrom:
        Optics(self.zoom_table)  # raises ValueError if no lens can have these fields of view
        return self

    @property
    def limits(self) -> Limits:
        """The camera's motion limits in the captured part."""
        return Limits(*self.pan_range_deg, *self.tilt_range_deg, *self.zoom_range, pan_endless=self.pan_endless)

    @property
    def optics(self) -> Optics:
        """The camera's fields of view, as measured in the pictures."""
        return Optics(self.zoom_table)


class SceneFile(Model):
    """The contents of ``scene.json``.

    ``start_s`` is the scene time at which sessions start by default. ``captured`` is None unless the scene was captured from a
    camera.
    """

    format: Literal[1] = 1
    name: Kebab
    title: str
    version: str
    blender_version: str
    viewpoints: list[SceneViewpoint] = Field(min_length=1)
    presets: list[ScenePreset] = Field(min_length=1)
    home_preset: Kebab
    instances: list[SceneInstance]
    texts: list[SceneText]
    actors: list[SceneActor] = []
    absent: list[str] = []
    start_s: Number = 0.0
    captured: CapturedFrom | None = None

    @property
    def limits(self) -> Limits:
        """Motion limits for a camera in this scene."""
        return Limits() if self.captured is None else self.captured.limits

    @property
    def optics(self) -> Optics:
        """Fields of view for a camera in this scene."""
        return AXIS_M5075_G if self.captured is None else self.captured.optics


class Layer(Model):
    """A file in a pack: its path relative to the viewpoint folder, its SHA-256 in hexadecimal and its size in pixels."""

    file: str = Field(pattern=r"^[a-z0-9][a-z0-9./-]*$")
    sha256: str = Field(pattern=r"^[0-9a-f]{64}$")
    width: int = Field(gt=0)
    height: int = Field(gt=0)


class Band(Model):
    """The band of the sphere that an equirectangular layer covers: all pans from -180 to 180, and these tilts."""

    top_tilt_deg: Number
    bottom_tilt_deg: Number


class Depth(Layer):
    """The depth layer. Code v in 1..65535 means ``near_m * (far_m / near_m) ** ((v - 1) / 65534)`` metres; 0 is the sky."""

    near_m: Number = Field(gt=0)
    far_m: Number = Field(gt=0)


MIN_RELATIVE_DENSITY = 0.9
"""A tile is sharp enough for a view if its pixel density is at least this fraction of the view's."""


class Tile(Model):
    """A sharper perspective picture and its instance IDs (same size), aimed at pan/tilt without roll."""

    pan_deg: Number
    tilt_deg: Number
    hfov_deg: Number = Field(gt=0, lt=120)
    colour: Layer
    ids: Layer

    @property
    def view(self) -> Perspective:
        """The perspective view that the tile shows."""
        return Perspective(self.pan_deg, self.tilt_deg, self.hfov_deg, self.colour.width, self.colour.height)

    def suits(self, view: Perspective) -> bool:
        """Return whether the tile's pixel density is at least ``MIN_RELATIVE_DENSITY`` times that of a view."""
        return self.view.focal_px >= MIN_RELATIVE_DENSITY * view.focal_px


class Extent(Model):
    """The whole silhouette of one instance from this viewpoint, including hidden parts.

    ``hull`` is the convex outline of the silhouette as pan/tilt directions; ``distance_m`` is the distance to its nearest point.
    """

    number: int
    solid_angle_sr: Number = Field(ge=0)
    hull: list[PanTilt]
    distance_m: Number = Field(gt=0)


class Sprite(Model):
    """One picture of an actor at one point on its path.

    ``left``, ``top``, ``width`` and ``height`` (pixels) locate the picture on the actor's sheet. It shows the perspective view that
    is aimed at ``pan_deg``/``tilt_deg`` with ``hfov_deg`` across ``width``. ``position_m`` is the actor's ground point in the
    picture. ``phase`` is the phase of a walker's stride, from 0 to 1; it is 0 for everything else.
    """

    path_s: Number
    phase: Number = 0.0
    position_m: Vec3
    pan_deg: Number
    tilt_deg: Number
    hfov_deg: Number
    left: int
    top: int
    width: int
    height: int


class ActorSheet(Model):
    """An actor's sprites from this viewpoint, in order of time along the path.

    ``colour`` contains straight RGBA, including the shadow (black with alpha). ``depth`` contains the distances of the actor's own
    pixels, coded as in the depth layer; it is 0 where the sheet shows only shadow or nothing. Walkers have ``stride_m``, the
    distance covered in one gait cycle; several sprites, one per phase, then share each ``path_s``.
    """

    number: int
    colour: Layer
    depth: Layer
    sprites: list[Sprite] = Field(min_length=1)
    stride_m: Number | None = None


class Manifest(Model):
    """The contents of a viewpoint pack's ``manifest.json``.

    ``seen`` is a mask for the panorama of a captured scene: 255 where the panorama shows what the camera saw, and 0 elsewhere. It
    is None for a rendered scene.
    """

    format: Literal[1] = 1
    scene: Kebab
    scene_version: str
    viewpoint: Kebab
    position_m: Vec3
    pan0_bearing_deg: Number
    blender_version: str
    samples: int
    band: Band
    base: Layer
    ids: Layer
    depth: Depth
    tiles: list[Tile]
    extents: list[Extent]
    actors: list[ActorSheet] = []
    seen: Layer | None = None

"""The stage of a scene. Objects that are placed on it become annotated instances.

Lengths are in metres and z points up. World north is +y, east is +x. A *bearing* is in degrees clockwise from north, seen from
above. Every builder models its object at the origin, standing on z = 0 and facing north (+y), with its right side towards +x.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import bpy
from mathutils import Matrix, Vector

INSTANCE_PROP = "scope_instance"
"""Custom property of every annotated Blender object. Its value is the id of the instance."""


@dataclass
class TextMark:
    """Readable text on an object, in object coordinates (before placement).

    ``centre`` is the centre of the text block. ``right`` and ``up`` are unit vectors that point along the line of text, as a
    viewer sees it, and towards the top of the letters. The outward normal is ``right x up``. ``cap_height_m`` is the height of a
    capital letter.
    """

    text: str
    centre: tuple[float, float, float]
    right: tuple[float, float, float]
    up: tuple[float, float, float]
    width_m: float
    height_m: float
    cap_height_m: float


@dataclass
class Built:
    """The result of a builder: Blender objects whose parent is ``root``, and the readable text on them."""

    root: bpy.types.Object
    objects: list[bpy.types.Object]
    texts: list[TextMark] = field(default_factory=list)

    @classmethod
    def of(cls, name: str, objects: Iterable[bpy.types.Object], texts: Sequence[TextMark] = ()) -> Built:
        """Return ``objects``, which are modelled around the origin, with a new empty as their parent."""
        root = bpy.data.objects.new(name, None)
        root.empty_display_size = 0.2
        bpy.context.scene.collection.objects.link(root)
        parts = list(objects)
        for part in parts:
            if part.parent is None:
                part.parent = root
        return cls(root, parts, list(texts))

    def copy(self) -> Built:
        """Return a linked duplicate. It shares the mesh data, so a hundred cones need as much memory as one."""
        copies: dict[bpy.types.Object, bpy.types.Object] = {}
        for obj in [self.root, *self.objects]:
            duplicate = obj.copy()
            bpy.context.scene.collection.objects.link(duplicate)
            copies[obj] = duplicate
        for obj, duplicate in copies.items():
            if obj.parent in copies:
                duplicate.parent = copies[obj.parent]
                duplicate.matrix_parent_inverse = obj.matrix_parent_inverse.copy()
        return Built(copies[self.root], [copies[o] for o in self.objects], list(self.texts))


@dataclass
class Instance:
    """An annotated object of the scene. ``number`` is its pixel value in instance masks (``object.pass_index``)."""

    id: str
    number: int
    category: str
    name: str
    built: Built
    attributes: dict[str, Any]
    parent: str | None = None


@dataclass
class Viewpoint:
    """A camera position (the optical centre). ``pan0_bearing_deg`` is the world bearing at which the pan is 0."""

    name: str
    position: tuple[float, float, float]
    pan0_bearing_deg: float
    description: str


@dataclass
class Preset:
    """A named pan, tilt and zoom at a viewpoint. One preset of the scene is the home preset."""

    name: str
    viewpoint: str
    pan_deg: float
    tilt_deg: float
    zoom: float
    description: str


@dataclass
class ActorPath:
    """A moving object, defined by its builder and its position over time.

    ``waypoints`` are ``(t_s, x, y, z)``. The actor moves between them at constant speed and faces in the direction of motion. The
    path repeats every ``period_s``. ``build`` builds the object for a gait phase in [0, 1), which is 0 for objects without legs.
    ``stride_m`` is the length of one gait cycle.
    """

    id: str
    number: int
    category: str
    name: str
    build: Any
    waypoints: list[tuple[float, float, float, float]]
    period_s: float
    attributes: dict[str, Any]
    stride_m: float | None = None


def _keep_materials(*, skip: tuple[str, ...] = ()) -> None:
    """Keep all materials unchanged. This is the default of ``Stage.finish``."""


class Stage:
    """The objects, viewpoints and presets that a scene module defines.

    Ids are ``category-NN`` in order of placement and never change afterwards. ``finish`` applies final changes
    to materials, such as haze. It is called once after the scene is built, and again for each moving object that is built later;
    ``skip`` then contains the names of the materials that are already finished.
    """

    def __init__(self, name: str, title: str) -> None:
        self.name = name
        self.title = title
        self.instances: list[Instance] = []
        self.viewpoints: list[Viewpoint] = []
        self.presets: list[Preset] = []
        self.home_preset: str | None = None
        self.actors: list[ActorPath] = []
        self.absent: list[str] = []
        self.start_s = 0.0
        self.finish: Callable[..., None] = _keep_materials
        self._numbers: dict[str, int] = {}

    def place(
        self,
        built: Built,
        category: str,
        name: str,
        location: tuple[float, float, float],
        bearing_deg: float = 0.0,
        *,
        parent: str | None = None,
        lean_deg: tuple[float, float] = (0.0, 0.0),
        scale: float = 1.0,
        **attributes: Any,
    ) -> str:
        """Place a built object in the world and annotate it as an instance.

        Args:
            name: A plain English noun phrase, such as "white van".
            lean_deg: Rotations in degrees about the object's x axis and y axis.
            attributes: Facts that questions can ask about, such as colour, material, state ("open", "lit", "parked") or facing.
                Values are short lower-case strings, numbers or booleans.

        Returns:
            The instance id.
        """
        self.put(built, location, bearing_deg, lean_deg=lean_deg, scale=scale)
        count = self._numbers.get(category, 0) + 1
        self._numbers[category] = count
        instance = Instance(
            f"{category.replace(' ', '-')}-{count:02d}", len(self.instances) + 1, category, name, built, attributes, parent
        )
        for obj in built.objects:
            obj[INSTANCE_PROP] = instance.id
            obj.pass_index = instance.number
        self.instances.append(instance)
        return instance.id

    def put(
        self,
        built: Built,
        location: tuple[float, float, float],
        bearing_deg: float = 0.0,
        *,
        lean_deg: tuple[float, float] = (0.0, 0.0),
        scale: float = 1.0,
    ) -> Built:
        """Place an object in the world without annotation, such as ground or distant scenery. Its pass index stays 0."""
        rotation = Matrix.Rotation(-math.radians(bearing_deg), 4, "Z")
        rotation @= Matrix.Rotation(math.radians(lean_deg[0]), 4, "X") @ Matrix.Rotation(math.radians(lean_deg[1]), 4, "Y")
        built.root.matrix_world = Matrix.Translation(Vector(location)) @ rotation @ Matrix.Scale(scale, 4)
        return built

    def viewpoint(self, name: str, position: tuple[float, float, float], pan0_bearing_deg: float, description: str) -> None:
        """Add a viewpoint at a position in metres."""
        self.viewpoints.append(Viewpoint(name, position, pan0_bearing_deg, description))

    def preset(
        self, name: str, viewpoint: str, pan_deg: float, tilt_deg: float, zoom: float, description: str, *, home: bool = False
    ) -> None:
        """Add a preset. If ``home`` is true, it becomes the scene's home preset."""
        self.presets.append(Preset(name, viewpoint, pan_deg, tilt_deg, zoom, description))
        if home:
            self.home_preset = name

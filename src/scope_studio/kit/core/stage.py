"""The stage, on which kit objects are placed and become annotated instances.

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
"""Custom property of every annotated Blender object: the string id of its instance."""


@dataclass
class TextMark:
    """One readable text on an object, in the object's own frame (before placement).

    ``centre`` is the middle of the text block. ``right`` points along the line of text as a viewer sees it, and ``up`` towards
    the top of the letters (unit vectors). The outward normal is ``right x up``. ``cap_height_m`` is the height of a capital
    letter.
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
    """The result of a builder: Blender objects that are all parented to ``root``, and the readable texts on them."""

    root: bpy.types.Object
    objects: list[bpy.types.Object]
    texts: list[TextMark] = field(default_factory=list)

    @classmethod
    def of(cls, name: str, objects: Iterable[bpy.types.Object], texts: Sequence[TextMark] = ()) -> Built:
        """Parent ``objects``, which are modelled around the origin, to a new empty and return them as one."""
        root = bpy.data.objects.new(name, None)
        root.empty_display_size = 0.2
        bpy.context.scene.collection.objects.link(root)
        parts = list(objects)
        for part in parts:
            if part.parent is None:
                part.parent = root
        return cls(root, parts, list(texts))

    def copy(self) -> Built:
        """Return a linked duplicate. It shares its mesh data, so a hundred cones need as much memory as one."""
        twins: dict[bpy.types.Object, bpy.types.Object] = {}
        for obj in [self.root, *self.objects]:
            twin = obj.copy()
            bpy.context.scene.collection.objects.link(twin)
            twins[obj] = twin
        for obj, twin in twins.items():
            if obj.parent in twins:
                twin.parent = twins[obj.parent]
                twin.matrix_parent_inverse = obj.matrix_parent_inverse.copy()
        return Built(twins[self.root], [twins[o] for o in self.objects], list(self.texts))


@dataclass
class Instance:
    """An annotated object of the scene. ``number`` is its value in the instance-number layer (also ``object.pass_index``)."""

    id: str
    number: int
    category: str
    name: str
    built: Built
    attributes: dict[str, Any]
    parent: str | None = None


@dataclass
class Viewpoint:
    """The optical centre of a camera. ``pan0_bearing_deg`` is the world bearing at which its pan is 0."""

    name: str
    position: tuple[float, float, float]
    pan0_bearing_deg: float
    description: str


@dataclass
class Preset:
    """A named pose in the pan/tilt/zoom frame of its viewpoint. One preset of the scene is the home preset."""

    name: str
    viewpoint: str
    pan_deg: float
    tilt_deg: float
    zoom: float
    description: str


@dataclass
class ActorPath:
    """A moving object: its builder, and its position over time.

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


def _leave_materials(*, skip: tuple[str, ...] = ()) -> None:
    """Leave the materials unchanged."""


class Stage:
    """Collects the objects that a scene module builds.

    Ids are ``category-NN`` in order of placement and never change afterwards. ``finish`` is the last step for materials, for
    example adding haze. It is called once after the scene is built, and again for each moving object that is built later. Then
    ``skip`` contains the names of the materials that are already finished.
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
        self.finish: Callable[..., None] = _leave_materials
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
            name: The plain English noun phrase that a person would use ("white van").
            attributes: Facts worth asking about, such as colour, material, state ("open", "lit", "parked") or facing. Values
                are short lower-case strings, numbers or booleans.

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
        """Place an object in the world without annotation (ground, distant scenery). Its pass index stays 0."""
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
        """Add a preset. With ``home``, it is the scene's home preset."""
        self.presets.append(Preset(name, viewpoint, pan_deg, tilt_deg, zoom, description))
        if home:
            self.home_preset = name

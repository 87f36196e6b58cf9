"""Build Cycles materials from expressions of ``Shader`` methods, each of which adds one or more nodes."""

from __future__ import annotations

from typing import Any

import bpy

Value = Any  # a socket, a number, or a tuple of 3 or 4 numbers


class Shader:
    """A material under construction. Methods add nodes and return an output socket; their arguments are sockets or constants."""

    def __init__(self, name: str) -> None:
        self.material = bpy.data.materials.new(name)
        self.tree = self.material.node_tree
        self.bsdf = next(n for n in self.tree.nodes if n.type == "BSDF_PRINCIPLED")

    def node(self, kind: str, **settings: Any) -> bpy.types.Node:
        """Add a node of type ``kind`` and set its properties."""
        node = self.tree.nodes.new(kind)
        for key, value in settings.items():
            setattr(node, key, value)
        return node

    def set_input(self, socket: bpy.types.NodeSocket, value: Value) -> None:
        """Link an input to a socket, or set it to a constant. Colours without an alpha value get an alpha of 1."""
        if value is None:
            return
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif socket.type == "RGBA" and len(value) == 3:
            socket.default_value = (*value, 1.0)
        else:
            socket.default_value = value

    def surface(self, **inputs: Value) -> bpy.types.Material:
        """Set inputs of the principled BSDF and return the material. Names are in snake case, such as ``base_color``."""
        by_name = {s.name.lower().replace(" ", "_"): s for s in self.bsdf.inputs}
        for key, value in inputs.items():
            self.set_input(by_name[key], value)
        return self.material

    def object_coords(self) -> bpy.types.NodeSocket:
        """Return the object coordinates of the shading point."""
        return self.node("ShaderNodeTexCoord").outputs["Object"]

    def position(self) -> bpy.types.NodeSocket:
        """Return the world position of the shading point."""
        return self.node("ShaderNodeNewGeometry").outputs["Position"]

    def random(self) -> bpy.types.NodeSocket:
        """Return a random number in [0, 1) for each object, so that linked copies differ."""
        return self.node("ShaderNodeObjectInfo").outputs["Random"]

    def xyz(self, vector: Value) -> tuple[Value, Value, Value]:
        """Return the three components of a vector."""
        node = self.node("ShaderNodeSeparateXYZ")
        self.set_input(node.inputs[0], vector)
        return node.outputs[0], node.outputs[1], node.outputs[2]

    def scaled(self, vector: Value, scale: tuple[float, float, float], offset: tuple[float, float, float] = (0, 0, 0)) -> Value:
        """Return ``vector`` multiplied by ``scale`` and shifted by ``offset``, component by component."""
        node = self.node("ShaderNodeMapping")
        self.set_input(node.inputs["Vector"], vector)
        node.inputs["Scale"].default_value = scale
        node.inputs["Location"].default_value = offset
        return node.outputs[0]

    def noise(self, vector: Value, scale: float, detail: float = 4.0, roughness: float = 0.55, distortion: float = 0.0) -> Value:
        """Return fractal noise in [0, 1]."""
        node = self.node("ShaderNodeTexNoise")
        self.set_input(node.inputs["Vector"], vector)
        for key, value in {"Scale": scale, "Detail": detail, "Roughness": roughness, "Distortion": distortion}.items():
            node.inputs[key].default_value = value
        return node.outputs[0]

    def voronoi(self, vector: Value, scale: float, feature: str = "F1", output: str = "Distance") -> Value:
        """Return an output of a Voronoi texture, such as the distance to the nearest cell centre."""
        node = self.node("ShaderNodeTexVoronoi", feature=feature)
        self.set_input(node.inputs["Vector"], vector)
        node.inputs["Scale"].default_value = scale
        return node.outputs[output]

    def math(self, operation: str, a: Value, b: Value = None, *, clamp: bool = False) -> Value:
        """Return the result of an operation of Blender's Math node."""
        node = self.node("ShaderNodeMath", operation=operation, use_clamp=clamp)
        self.set_input(node.inputs[0], a)
        self.set_input(node.inputs[1], b)
        return node.outputs[0]

    def ramp(
        self, value: Value, low: float, high: float, to_low: float = 0.0, to_high: float = 1.0, *, smooth: bool = True
    ) -> Value:
        """Map ``low..high`` to ``to_low..to_high``, clamped."""
        node = self.node("ShaderNodeMapRange", interpolation_type="SMOOTHSTEP" if smooth else "LINEAR")
        for index, number in enumerate([value, low, high, to_low, to_high]):
            self.set_input(node.inputs[index], number)
        return node.outputs[0]

    def band(self, value: Value, low: float, high: float, soft: float = 0.002) -> Value:
        """Return 1 where ``low < value < high`` and 0 elsewhere, with soft edges."""
        return self.math("MULTIPLY", self.ramp(value, low - soft, low + soft), self.ramp(value, high - soft, high + soft, 1.0, 0.0))

    def mix(self, factor: Value, a: Value, b: Value, blend: str = "MIX") -> Value:
        """Mix two colours: ``a`` where the factor is 0, ``b`` where it is 1."""
        node = self.node("ShaderNodeMix", data_type="RGBA", blend_type=blend)
        self.set_input(node.inputs[0], factor)
        self.set_input(node.inputs[6], a)
        self.set_input(node.inputs[7], b)
        return node.outputs[2]

    def bump(self, height: Value, strength: float = 0.3, distance: float = 0.01) -> Value:
        """Return the normal of a surface that is displaced by ``height``."""
        node = self.node("ShaderNodeBump")
        node.inputs["Strength"].default_value = strength
        node.inputs["Distance"].default_value = distance
        self.set_input(node.inputs["Height"], height)
        return node.outputs[0]


def plain(name: str, colour: tuple[float, float, float], roughness: float = 0.5, metallic: float = 0.0) -> bpy.types.Material:
    """Return a material of one colour, shared by name."""
    existing = bpy.data.materials.get(name)
    if existing is not None:
        return existing
    return Shader(name).surface(base_color=colour, roughness=roughness, metallic=metallic)

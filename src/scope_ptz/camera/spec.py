"""Camera specs: strings that select a camera, such as ``highway-works``, ``blender:yard.blend`` or ``axis://10.0.0.7``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class CameraSpec:
    """A parsed camera spec, as passed to camera factories and plug-ins.

    Attributes:
        scheme: The camera type, in lower case: ``sim``, ``blender``, or the name of a plug-in.
        address: The text after the scheme, without leading slashes or options.
        options: The ``NAME=VALUE`` pairs after a question mark, as in ``blender:yard.blend?samples=4``.
        name: The camera's name in ``scope.yaml``; empty if it has none.
    """

    scheme: str
    address: str
    options: Mapping[str, str] = field(default_factory=dict, hash=False)
    name: str = ""

    def __str__(self) -> str:
        if self.name:
            return self.name
        options = "&".join(f"{name}={value}" for name, value in self.options.items())
        return f"{self.scheme}:{self.address}" + (f"?{options}" if options else "")

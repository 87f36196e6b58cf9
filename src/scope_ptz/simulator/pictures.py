"""The picture files in a viewpoint folder. Their checksums and sizes are verified before use."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import PackError
from scope_ptz.simulator import layers
from scope_ptz.simulator.files import read_regular_file
from scope_ptz.simulator.models import Layer


class Pictures:
    """Reads the layers in one folder without caching them. Raises ``PackError`` for files that do not match the manifest."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def colour(self, layer: Layer) -> NDArray[np.uint8]:
        """Return a colour layer as (H, W, 3) RGB, or (H, W, 4) RGBA for sprite sheets."""
        return self._check_size(layer, layers.read_colour(self.verify(layer)))

    def numbers(self, layer: Layer) -> NDArray[np.uint16]:
        """Return a layer of (H, W) instance IDs (0 = not annotated) or distance codes."""
        return self._check_size(layer, layers.read_ids(self.verify(layer)))

    def coded_numbers(self, layer: Layer) -> NDArray[np.uint8] | NDArray[np.uint16]:
        """Return a layer of IDs or distance codes as stored in the file; ``layers.decode_numbers`` decodes any of its rows."""
        return self._check_size(layer, layers.read_coded_numbers(self.verify(layer)))

    def verify(self, layer: Layer) -> Path:
        """Verify the checksum of a layer's file and return its path."""
        path = (self.folder / layer.file).resolve()
        if not path.is_relative_to(self.folder.resolve()):
            raise PackError(f"{self.folder / 'manifest.json'} names a file outside its folder: {layer.file}. Do not use this pack.")
        try:
            digest = hashlib.sha256(read_regular_file(path)).hexdigest()
        except OSError as error:
            raise PackError(f"{path} is missing or cannot be read ({error.strerror}). Restore it or bake again.") from error
        if digest != layer.sha256:
            raise PackError(f"{path} is damaged: its checksum differs from the manifest. Restore the pack or bake it again.")
        return path

    def _check_size(self, layer: Layer, image: NDArray[np.generic]) -> NDArray:  # type: ignore[type-arg]
        if image.shape[:2] != (layer.height, layer.width):
            raise PackError(
                f"{self.folder / layer.file} is {image.shape[1]}x{image.shape[0]} pixels, but its manifest states "
                f"{layer.width}x{layer.height}. Bake it again."
            )
        image.flags.writeable = False
        return image

"""Ground truth with simulated perception errors, for robustness tests.

The errors depend only on the seed, the frame and the question or description.
"""

from __future__ import annotations

import hashlib
import math
import random
from dataclasses import dataclass, replace

from scope_ptz.builtin_names import NOISY_SOURCE
from scope_ptz.camera.base import Frame
from scope_ptz.perception.ground_truth import GroundTruthPerception
from scope_ptz.simulator.truth import MIN_CAP_HEIGHT_PX, Sighting, TextSighting, ViewTruth

# Characters, each with the similar character for which it may be mistaken.
_LOOKALIKES = {
    **dict(zip("0O1I5S8B2Z6G", "O0I1S5B8Z2G6", strict=True)),
    **dict(zip("aceoimnrtlhuvy", "oeacjnmvfibvuv", strict=True)),
    **dict(zip("ACDEFHKMNPRTUVWXY", "RGOFEMXHMRPIVUVKV", strict=True)),
    **dict(zip("3479", "8417", strict=True)),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Noise:
    """The probabilities and sizes of simulated errors.

    Attributes:
        miss: A thing of ``pixels`` pixels is missed with probability ``miss * exp(-pixels / miss_scale_px)``.
        miss_scale_px: See ``miss``.
        duplicate: The probability that a thing is reported twice.
        misread: The probability that a character of a barely legible text is misread; larger text is misread less often.
        jitter: Each side of a box moves by up to this fraction of the box's width or height.
    """

    miss: float = 0.35
    miss_scale_px: float = 4000.0
    duplicate: float = 0.04
    misread: float = 0.08
    jitter: float = 0.03


class NoisyPerception(GroundTruthPerception):
    """Ground truth with simulated errors. Repeating a question gives the same errors; different questions give different ones."""

    name = NOISY_SOURCE

    def __init__(self, truth: GroundTruthPerception, seed: int, noise: Noise | None = None) -> None:
        super().__init__(truth.open_scene, truth.read_truth)
        self._seed = seed
        self._noise = noise or Noise()

    def perceive(self, truth: ViewTruth, frame: Frame, request: str) -> ViewTruth:
        """Return the truth with missed and duplicate things, shifted boxes and misread characters."""
        key = f"{self._seed}|{frame.origin}|{frame.projection}|{' '.join(request.lower().split())}"
        rng = random.Random(hashlib.sha256(key.encode()).digest())
        sightings: list[Sighting] = []
        for sighting in truth.sightings:
            missed = rng.random() < self._noise.miss * math.exp(-sighting.pixels / self._noise.miss_scale_px)
            duplicated = rng.random() < self._noise.duplicate
            shifted = [self._shift_box(sighting, rng) for _ in range(2)]
            sightings += shifted[: 0 if missed else 2 if duplicated else 1]
        return ViewTruth(tuple(sightings), tuple(self._misread(t, rng) for t in truth.texts))

    def _shift_box(self, sighting: Sighting, rng: random.Random) -> Sighting:
        x0, y0, x1, y1 = sighting.box
        fraction = self._noise.jitter
        dx, dy = ((rng.uniform(-fraction, fraction) * size for _ in range(2)) for size in (x1 - x0, y1 - y0))
        sides = [min(max(v + d, 0.0), 1.0) for v, d in zip((x0, x1, y0, y1), (*dx, *dy), strict=True)]
        return replace(sighting, box=(min(sides[:2]), min(sides[2:]), max(sides[:2]), max(sides[2:])))

    def _misread(self, text: TextSighting, rng: random.Random) -> TextSighting:
        chance = self._noise.misread * min(1.0, MIN_CAP_HEIGHT_PX / max(text.cap_height_px, 1e-6))
        read = "".join(_LOOKALIKES.get(c, c) if rng.random() < chance else c for c in text.text.text)
        return replace(text, text=text.text.model_copy(update={"text": read}))

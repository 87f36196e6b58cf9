"""Measures of similarity between images."""

import numpy as np
import pytest
from numpy.typing import NDArray

from scope_ptz.blender.parity import box_ious, sharpness, ssim


def noise(seed: int, strength: float = 40.0) -> NDArray[np.uint8]:
    grain = np.random.default_rng(seed).normal(120, strength, (90, 160, 3))
    return np.asarray(np.clip(grain, 0, 255), dtype=np.uint8)


def test_an_image_is_similar_to_itself_and_not_to_other_noise() -> None:
    assert ssim(noise(1), noise(1)) == pytest.approx(1.0)
    assert ssim(noise(1), noise(2)) < 0.2


def test_ssim_agrees_with_its_definition_at_one_window() -> None:
    a, b = (np.repeat(noise(k)[:7, :7, :1], 3, axis=2) for k in (1, 2))
    x, y = a[..., 0].astype(float), b[..., 0].astype(float)
    c1, c2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2
    covariance = np.cov(x.ravel(), y.ravel())
    expected = (2 * x.mean() * y.mean() + c1) * (2 * covariance[0, 1] + c2)
    expected /= (x.mean() ** 2 + y.mean() ** 2 + c1) * (covariance[0, 0] + covariance[1, 1] + c2)
    assert ssim(a, b) == pytest.approx(expected)


def test_a_mask_restricts_both_measures() -> None:
    a, b = noise(1), noise(1)
    b[:, 80:] = noise(2)[:, 80:]
    mask = np.zeros((90, 160), dtype=bool)
    mask[:, :76] = True
    assert ssim(a, b) < 0.7
    assert ssim(a, b, mask) == pytest.approx(1.0)
    assert sharpness(noise(1, 5), mask) < sharpness(noise(1, 40), mask)


def test_boxes_are_compared_for_the_objects_of_the_reference() -> None:
    reference, other = np.zeros((50, 50), dtype=np.uint16), np.zeros((50, 50), dtype=np.uint16)
    reference[10:30, 10:30], other[10:30, 10:40] = 4, 4
    reference[0:5, 0:5] = 5
    reference[40:50, 0:45] = 6
    assert box_ious(other, reference, 100) == {4: pytest.approx(2 / 3), 6: 0.0}

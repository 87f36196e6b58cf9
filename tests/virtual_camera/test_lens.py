"""Focus and iris of the virtual device: their motion, and what they do to the picture."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.lens import AUTO_IRIS, SHARP_FOCUS, TRAVEL_S, VirtualLens


class Clock:
    now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def lens(clock: Clock) -> VirtualLens:
    return VirtualLens(clock)


def picture() -> NDArray[np.uint8]:
    return np.random.default_rng(0).integers(40, 200, (180, 1280, 3), np.uint8)


def sharpness(image: NDArray[np.uint8]) -> float:
    return float(cv2.Laplacian(image, cv2.CV_64F).var())


def test_an_automatic_lens_leaves_the_picture_as_it_is(lens: VirtualLens) -> None:
    image = picture()
    assert lens.apply(image, 1.0) is image
    assert (lens.autofocus, lens.autoiris, lens.focus, lens.iris) == (True, True, SHARP_FOCUS, AUTO_IRIS)


def test_the_focus_takes_time_and_can_be_stopped(lens: VirtualLens, clock: Clock) -> None:
    lens.move_focus(0.0)
    assert lens.is_focusing
    assert not lens.autofocus
    clock.now_s = 0.3
    assert lens.focus == pytest.approx(SHARP_FOCUS - 0.3 / TRAVEL_S)
    lens.stop_focus()
    held = lens.focus
    clock.now_s = 9.0
    assert lens.focus == held
    lens.set_autofocus(on=True)
    clock.now_s = 20.0
    assert (lens.focus, lens.is_focusing) == (SHARP_FOCUS, False)


def test_a_driven_focus_ends_at_the_end_of_its_range(lens: VirtualLens, clock: Clock) -> None:
    lens.drive_focus(0.5)
    clock.now_s = 0.2
    assert lens.focus == pytest.approx(SHARP_FOCUS + 0.5 * 0.2 / TRAVEL_S)
    clock.now_s = 60.0
    assert lens.focus == 1.0


def test_defocus_blurs_more_with_distance_and_zoom(lens: VirtualLens, clock: Clock) -> None:
    image, seen = picture(), []
    for position in (SHARP_FOCUS, SHARP_FOCUS - 0.1, SHARP_FOCUS - 0.3):
        lens.move_focus(position)
        clock.now_s += 10.0
        seen.append(sharpness(lens.apply(image, 1.0)))
    assert seen[0] > 1.5 * seen[1] > 1.5 * seen[2]
    assert sharpness(lens.apply(image, 4.0)) < seen[2]


@given(st.floats(0, 1), st.floats(0, 1))
def test_an_open_iris_is_brighter(first: float, second: float) -> None:
    image = picture()
    means = []
    for opening in sorted((first, second)):
        lens = VirtualLens(Clock())
        lens.set_iris(opening)
        means.append(lens.apply(image, 1.0).mean())
    assert means[0] <= means[1]


def test_holding_the_iris_changes_nothing(lens: VirtualLens) -> None:
    lens.set_autoiris(on=False)
    assert lens.iris == AUTO_IRIS
    lens.set_iris(0.0)
    dark = lens.apply(picture(), 1.0).mean()
    lens.set_autoiris(on=True)
    assert dark < 0.7 * lens.apply(picture(), 1.0).mean()


def test_the_device_shows_its_lens_and_a_reboot_resets_it(analytic_scene: Scene) -> None:
    device = VirtualDevice(analytic_scene, width=320, height=180, time_scale=1000)
    before = device.expose().image
    device.lens.set_iris(0.1)
    assert device.expose().image.mean() < before.mean()
    device.reboot()
    assert np.array_equal(device.expose().image, before)

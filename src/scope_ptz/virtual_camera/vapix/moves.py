"""Movement commands in ``ptz.cgi``."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scope_ptz.camera.capabilities import Velocity
from scope_ptz.errors import InputError
from scope_ptz.geometry import Perspective, Pose, pan_tilt_deg
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.vapix import scales
from scope_ptz.virtual_camera.vapix.arguments import MAX_SHOWN_CHARS, Arguments
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

STEP_FRACTION = 0.25
"""Fraction of the field of view by which commands such as ``move=left`` turn the camera."""

DIRECTIONS = {
    "up": (0, 1),
    "down": (0, -1),
    "left": (-1, 0),
    "right": (1, 0),
    "upleft": (-1, 1),
    "upright": (1, 1),
    "downleft": (-1, -1),
    "downright": (1, -1),
}
WORDS = ("home", *DIRECTIONS, "stop")

ABSOLUTE, RELATIVE = ("pan", "tilt", "zoom"), ("rpan", "rtilt", "rzoom")
CONTINUOUS = ("continuouspantiltmove", "continuouszoommove")
PRESETS = ("gotoserverpresetname", "gotoserverpresetno", "gotodevicepreset")
PIXELS = ("center", "areazoom")
COMMANDS = ("move", *PRESETS, *PIXELS, *CONTINUOUS, *ABSOLUTE, *RELATIVE)
"""Arguments of ``ptz.cgi`` that move the camera."""


def move(camera: VapixCamera, arguments: Arguments) -> None:
    """Carry out the movement commands in a request. If there are several types, only one of them is carried out.

    Raises:
        InputError: An argument is invalid, or there is no such preset. In this case, nothing moves.
    """
    device = camera.device
    if "move" in arguments:
        _move_word(camera, arguments.choice("move", WORDS))
    elif any(name in arguments for name in PRESETS):
        _go(camera, _preset_pose(device, arguments))
    elif any(name in arguments for name in PIXELS):
        _go(camera, _pixel_pose(device, arguments))
    elif any(name in arguments for name in CONTINUOUS):
        _drive(device, arguments)
    else:
        _go(camera, _target(device, arguments))


def _go(camera: VapixCamera, pose: Pose) -> None:
    camera.device.move(pose, speed_fraction=scales.speed_fraction(camera.speed), zoom_fraction=1.0)


def _move_word(camera: VapixCamera, word: str) -> None:
    device = camera.device
    if word == "stop":
        device.stop()
    elif word == "home":
        _go(camera, device.home)
    else:
        right, up = DIRECTIONS[word]
        view = _view(device, device.pose(), device.width, device.height)
        _go(camera, device.pose().turned(right * STEP_FRACTION * view.hfov_deg, up * STEP_FRACTION * view.vfov_deg))


def _target(device: VirtualDevice, arguments: Arguments) -> Pose:
    """Return the target of the absolute and relative arguments. Axes that are not named keep their current target."""
    current, destination = device.pose(), device.destination
    pan, tilt, zoom = destination.pan_deg, destination.tilt_deg, destination.zoom
    if "pan" in arguments:
        pan = arguments.number("pan", -180, 180)
    elif "rpan" in arguments:
        pan = current.pan_deg + arguments.number("rpan", -360, 360)
    if "tilt" in arguments:
        tilt = arguments.number("tilt", -180, 180)
    elif "rtilt" in arguments:
        tilt = current.tilt_deg + arguments.number("rtilt", -360, 360)
    if "zoom" in arguments:
        zoom = scales.magnification(arguments.integer("zoom", 1, scales.MAX_ZOOM_STEP), device.limits)
    elif "rzoom" in arguments:
        steps = arguments.integer("rzoom", -scales.MAX_ZOOM_STEP, scales.MAX_ZOOM_STEP)
        zoom = scales.magnification(scales.zoom_step(current.zoom, device.limits) + steps, device.limits)
    return Pose(pan, tilt, zoom)


def _drive(device: VirtualDevice, arguments: Arguments) -> None:
    """Drive pan and tilt, zoom, or all three continuously. Axes that are not named keep their velocity."""
    velocity, head = device.commanded_velocity, device.head
    if "continuouspantiltmove" in arguments:
        pan, tilt = (scales.speed_fraction(value) for value in arguments.numbers("continuouspantiltmove", 2))
        velocity = replace(velocity, pan_dps=pan * head.pan.speed, tilt_dps=tilt * head.tilt.speed)
    if "continuouszoommove" in arguments:
        fraction = arguments.number("continuouszoommove", -100, 100) / 100
        velocity = replace(velocity, zoom_rate=fraction * head.zoom.speed)
    if velocity == Velocity():
        device.stop()
    else:
        device.drive(velocity)


def _preset_pose(device: VirtualDevice, arguments: Arguments) -> Pose:
    if "gotoserverpresetname" in arguments:
        return device.find_preset(arguments.text("gotoserverpresetname")[:MAX_SHOWN_CHARS]).pose
    name = "gotoserverpresetno" if "gotoserverpresetno" in arguments else "gotodevicepreset"
    return device.preset(arguments.integer(name, 0, 10_000)).pose


def _pixel_pose(device: VirtualDevice, arguments: Arguments) -> Pose:
    """Return the pose that centres a pixel of the image; for ``areazoom``, with a new magnification."""
    width = arguments.integer("imagewidth", 1, 100_000) if "imagewidth" in arguments else device.width
    height = arguments.integer("imageheight", 1, 100_000) if "imageheight" in arguments else device.height
    current = device.pose()
    if "areazoom" in arguments:
        x, y, percent = arguments.numbers("areazoom", 3)
        if percent < 1:
            raise InputError(f"areazoom: the zoom must be 1 or more, got {percent:g}")
        zoom = device.optics.zoom_for_focal(device.optics.focal(current.zoom) * percent / 100)
    else:
        (x, y), zoom = arguments.numbers("center", 2), current.zoom
    point = np.clip([x / width, y / height], 0.0, 1.0)
    pan, tilt = pan_tilt_deg(_view(device, current, width, height).directions(point))
    return Pose(device.limits.aim_pan_deg(float(pan)), float(tilt), zoom)


def _view(device: VirtualDevice, pose: Pose, width: int, height: int) -> Perspective:
    return Perspective(pose.pan_deg, pose.tilt_deg, device.optics.hfov_deg(pose.zoom), width, height)

"""Use your own camera: a pinhole camera inside a painted sphere. The conformance suite checks it first."""

import asyncio
from contextlib import asynccontextmanager

import numpy as np

import scope_ptz
from scope_ptz.contracts import (
    Arrival,
    CameraInfo,
    Frame,
    Limits,
    Optics,
    Perspective,
    Pose,
    PresetInfo,
    UnknownNameError,
    WallClock,
)

HOME = Pose(0, 0, 1)
PRESETS = {"left": Pose(-40, 0, 1), "sign": Pose(40, 5, 2)}


class PaintedSphere(scope_ptz.Camera):
    info = CameraInfo("painted sphere", Limits(-90, 90, -30, 30, 1, 4), Optics(((1, 60.0), (4, 16.0))), 640, 360, simulated=False)

    def __init__(self):
        self.clock, self.now = WallClock(), HOME

    async def pose(self):
        return self.now

    async def move(self, pose):
        self.now, clamped = self.info.limits.clamp(pose)
        return Arrival(self.now, clamped)

    async def go_home(self):
        return await self.move(HOME)

    async def presets(self):
        return [PresetInfo(name) for name in PRESETS]

    async def go_to_preset(self, name):
        if name not in PRESETS:
            raise UnknownNameError("preset", name, PRESETS)
        return await self.move(PRESETS[name])

    async def frame(self):
        hfov_deg = self.info.optics.hfov_deg(self.now.zoom)
        view = Perspective(self.now.pan_deg, self.now.tilt_deg, hfov_deg, 640, 360)
        points = np.stack(np.meshgrid((np.arange(640) + 0.5) / 640, (np.arange(360) + 0.5) / 360), axis=-1)
        image = (127.5 + 127 * view.directions(points)).astype(np.uint8)  # each direction has its own colour
        return Frame(image, self.now, hfov_deg, self.clock.now_s(), view)

    async def stop(self):
        """Moves take no time, so there is nothing to stop."""


class Check(scope_ptz.CameraConformance):
    @asynccontextmanager
    async def camera(self):
        yield PaintedSphere()


def main():
    print("Contract violations:", asyncio.run(Check().findings()) or "none")
    with scope_ptz.open(PaintedSphere()) as scope:
        print(scope.ask("pan right 20 degrees and zoom in 2x"))
        print(scope.ask("go to the sign preset and tilt up 50 degrees"))
        print("The camera is at", scope.pose())


if __name__ == "__main__":
    main()

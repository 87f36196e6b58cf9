"""Use your own perception backend, which detects orange objects by their colour. The conformance suite checks it first."""

import asyncio
from contextlib import asynccontextmanager
from time import perf_counter

import cv2

import scope_ptz
from scope_ptz.contracts import Answer, Box, Caption, Detections, Frame, Points


class Orange(scope_ptz.Perception):
    name = "orange"
    skills = frozenset({"detect"})

    async def detect(self, frame: Frame, description: str) -> Detections:
        start_s = perf_counter()
        found = []
        if "cone" in description or "orange" in description:
            hsv = cv2.cvtColor(frame.image, cv2.COLOR_RGB2HSV)
            mask = cv2.inRange(hsv, (4, 170, 150), (14, 255, 255))
            _, _, boxes, _ = cv2.connectedComponentsWithStats(cv2.dilate(mask, None))
            found = [box for box in boxes[1:] if box[4] > 60]  # the first one is the background
        w, h = frame.width, frame.height
        boxes = tuple(Box(x_min=x / w, y_min=y / h, x_max=(x + dx) / w, y_max=(y + dy) / h) for x, y, dx, dy, _ in found)
        return Detections(source=self.name, boxes=boxes, latency_s=perf_counter() - start_s)

    async def point(self, frame: Frame, description: str) -> Points:
        raise scope_ptz.PerceptionError("This backend only detects.")

    async def query(self, frame: Frame, question: str) -> Answer:
        raise scope_ptz.PerceptionError("This backend only detects.")

    async def caption(self, frame: Frame) -> Caption:
        raise scope_ptz.PerceptionError("This backend only detects.")


class Check(scope_ptz.PerceptionConformance):
    present = "orange things"

    @asynccontextmanager
    async def perception(self):
        yield Orange()

    def frame(self) -> Frame:
        with scope_ptz.open("highway-works") as scope:
            return scope.frame()


def main() -> None:
    print("Contract violations:", asyncio.run(Check().findings()) or "none")
    with scope_ptz.open("highway-works", perception=Orange()) as scope:
        print("By colour:    ", scope.ask("how many cones are there?"))
    with scope_ptz.open("highway-works") as scope:
        print("Ground truth: ", scope.ask("how many cones are there?"))


if __name__ == "__main__":
    main()

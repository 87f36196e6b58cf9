"""Measure how many of the legible texts of a scene an OCR engine (rapidocr) reads in random views.

    python benchmarks/reading.py [--scene NAME ...] [--views 24] [--seed 1] [--misses]
    python benchmarks/reading.py --tasks core

Each view is aimed near a text, at a zoom at which its letters are large enough to be legible. All legible texts in the view are
counted. A text counts as read if the engine's output at its position contains it or has a similarity of at least 5/6 to it. Case,
spaces and punctuation are ignored.

With ``--tasks`` (a split or a task file), the views are those in which the reference programs of the OCR tasks read texts, and the
benchmark's answer check decides whether the engine's output at the position of the answer is correct.

The benchmark requires the ``ocr`` extra.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
from collections.abc import Iterator, Sequence
from difflib import SequenceMatcher
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rapidocr import RapidOCR

from scope_ptz.bench.answers import agrees, parse_answer
from scope_ptz.bench.tasks.splits import load_split
from scope_ptz.bench.tasks.task import Task
from scope_ptz.factory.worlds import open_worlds
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, pan_tilt_deg
from scope_ptz.simulator.pack import Scene, find_scenes
from scope_ptz.simulator.truth import MIN_CAP_HEIGHT_PX, TextSighting, view_truth
from scope_ptz.simulator.views import picture
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers

WIDTH, HEIGHT = 1280, 720
MIN_SIMILARITY = 5 / 6
"""Minimum similarity between a text and the engine's output for the text to count as read."""
MARGIN = 0.012
"""Maximum distance of the middle of the engine's box from the box of a text, as a fraction of the frame."""


def main() -> int:
    """Measure the selected scenes or tasks and print the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", action="append", help="scene to measure; repeatable (default: all)")
    parser.add_argument("--search", type=Path, action="append", default=[], help="additional folder of scenes; repeatable")
    parser.add_argument("--views", type=int, default=24, help="number of views per scene (default: 24)")
    parser.add_argument("--seed", type=int, default=1, help="seed for the random views (default: 1)")
    parser.add_argument("--misses", action="store_true", help="list the texts that were not read")
    parser.add_argument("--tasks", help="split or task file whose OCR tasks are measured instead of random views")
    arguments = parser.parse_args()
    if arguments.tasks:
        _measure_tasks([task for task in load_split(arguments.tasks) if task.category == "ocr"], RapidOCR(), arguments.misses)
        return 0
    folders = find_scenes(arguments.search)
    engine = RapidOCR()
    for name in arguments.scene or list(folders):
        if name not in folders:
            print(f"No scene '{name}'. Known scenes: {', '.join(folders) or 'none'}.", file=sys.stderr)
            return 2
        read, missed = _measure(Scene(folders[name]), engine, arguments.views, arguments.seed)
        total = read + len(missed)
        print(f"{name}: {read} of {total} legible texts read ({read / max(1, total):.1%}) in {arguments.views} views", flush=True)
        if arguments.misses:
            for line in missed:
                print(f"  {line}")
    return 0


def _measure(scene: Scene, engine: RapidOCR, views: int, seed: int) -> tuple[int, list[str]]:
    """Read random views of a scene. Return the number of texts read, and descriptions of the texts that were not read."""
    number_read, missed = 0, []
    for viewpoint, pose, legible in _views(scene, views, random.Random(seed)):
        view = _perspective(pose)
        lines_read = _read_lines(engine, picture(scene, viewpoint, view, 0.0))
        for text in legible:
            read = _read_at(text, lines_read)
            if _similarity(text.text.text, read) >= MIN_SIMILARITY:
                number_read += 1
            else:
                place = f"{viewpoint} {pose.pan_deg:.1f} {pose.tilt_deg:.1f} {pose.zoom:.2f}x"
                size = f"capitals {text.cap_height_px:.0f} px, {text.angle_deg:.0f} deg"
                missed.append(f"{text.text.text!r} read as {read!r}, {size}, {place}")
    return number_read, missed


def _measure_tasks(tasks: Sequence[Task], engine: RapidOCR, misses: bool) -> None:
    """Read the views of OCR tasks and print the number of tasks that are answered correctly."""
    worlds, correct, missed = open_worlds(tasks), 0, []
    for task in tasks:
        scene, parts = worlds[task.world], []
        for evidence in task.evidence:
            aim = evidence.aim
            view, instances = _perspective(Pose(aim.pan_deg, aim.tilt_deg, aim.zoom)), [item.instance for item in evidence.items]
            lines_read = _read_lines(engine, picture(scene, aim.viewpoint, view, task.time_s))
            texts = {t.text.id: t for t in view_truth(scene, aim.viewpoint, view, task.time_s).texts}
            parts += [_read_at(texts[name], lines_read) for name in instances if name in texts]
        read = " ".join(parts)
        if agrees(task.expected, parse_answer(task.expected, f'It reads "{read}".')):
            correct += 1
        else:
            missed.append(f"{task.id} {correct_answers(task.expected)[0]!r} read as {read!r}: {task.instruction}")
    print(f"{correct} of {len(tasks)} OCR tasks answered correctly ({correct / max(1, len(tasks)):.1%})")
    if misses:
        print("\n".join(f"  {line}" for line in missed))


def _views(scene: Scene, count: int, rng: random.Random) -> Iterator[tuple[str, Pose, list[TextSighting]]]:
    """Yield random views that show at least one legible text, as viewpoint, pose and legible texts."""
    limits, yielded = Limits(), 0
    for _ in range(40 * count):
        place, text = rng.choice(scene.file.viewpoints), rng.choice(scene.file.texts)
        offset = np.array(text.centre_m) - np.array(place.position_m)
        pan, tilt = (float(v) for v in pan_tilt_deg(offset))
        caps_rad = text.cap_height_m / float(np.linalg.norm(offset))
        for _ in range(4):  # Try to find a zoom at which this text is legible.
            zoom = rng.uniform(limits.min_zoom, limits.max_zoom)
            if caps_rad * _perspective(Pose(zoom=zoom)).focal_px >= MIN_CAP_HEIGHT_PX:
                break
        else:
            continue
        pan += rng.uniform(-5, 5) / zoom - place.pan0_bearing_deg
        pose, _ = limits.clamp(Pose(limits.aim_pan_deg(pan), tilt + rng.uniform(-3, 3) / zoom, zoom))
        legible = view_truth(scene, place.name, _perspective(pose), 0.0).legible
        if legible:
            yield place.name, pose, list(legible)
            yielded += 1
            if yielded == count:
                return


def _perspective(pose: Pose) -> Perspective:
    return Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), WIDTH, HEIGHT)


def _read_lines(engine: RapidOCR, image: NDArray[np.uint8]) -> list[tuple[float, float, str]]:
    """Return the middle (normalised x and y) and the text of each line that the engine finds."""
    result = engine(image[..., ::-1])
    if result.boxes is None or result.txts is None:
        return []
    middles = np.asarray(result.boxes).mean(axis=1) / (WIDTH, HEIGHT)
    return [(float(x), float(y), str(text)) for (x, y), text in zip(middles, result.txts, strict=True)]


def _read_at(text: TextSighting, lines: Sequence[tuple[float, float, str]]) -> str:
    """Return the engine's output within the box of a text, in reading order."""
    x0, y0, x1, y1 = text.box
    in_box = [w for w in lines if x0 - MARGIN <= w[0] <= x1 + MARGIN and y0 - MARGIN <= w[1] <= y1 + MARGIN]
    return " ".join(w[2] for w in sorted(in_box, key=lambda w: (round(w[1] * 40), w[0])))


def _similarity(expected: str, read: str) -> float:
    """Return the similarity of two texts in [0, 1], ignoring case, spaces and punctuation.

    The similarity is 1 if ``read`` contains ``expected``.
    """
    a, b = (re.sub(r"[^a-z0-9]", "", s.lower()) for s in (expected, read))
    if a and a in b:
        return 1.0
    return SequenceMatcher(None, a, b, autojunk=False).ratio()


if __name__ == "__main__":
    sys.exit(main())

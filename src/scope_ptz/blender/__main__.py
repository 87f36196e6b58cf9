"""``python -m scope_ptz.blender bake|verify SCENE``: what ``scope scene bake`` does, without the rest of the command line."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from scope_ptz.blender.bake import bake
from scope_ptz.blender.client import BlenderWorker
from scope_ptz.blender.environment import worker_command
from scope_ptz.blender.quality import QUALITIES, named_quality
from scope_ptz.blender.verify import draw_poses, verify
from scope_ptz.settings import load_settings
from scope_ptz.world.pack import Scene


def main() -> None:
    settings = load_settings()
    parser = argparse.ArgumentParser(prog="python -m scope_ptz.blender")
    parser.add_argument("operation", choices=["bake", "verify"])
    parser.add_argument("scene", help="name of a scene, or a Python file with build(stage)")
    parser.add_argument("--out", type=Path, required=True, help="the scene's folder")
    parser.add_argument("--quality", choices=sorted(QUALITIES), default="standard")
    parser.add_argument("--viewpoint", action="append")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--wide", type=int, default=8, help="verify: poses at the wide end")
    parser.add_argument("--zoomed", type=int, default=8, help="verify: poses at 2x to 5x in tiles")
    parser.add_argument("--blender-python", type=Path, default=settings.blender_python)
    parser.add_argument("--cache-dir", type=Path, default=settings.cache_dir)
    options = parser.parse_args()
    if options.operation == "bake":
        _bake(options)
    else:
        _verify(options)


def _bake(options: argparse.Namespace) -> None:
    baked = bake(
        options.scene,
        options.out,
        quality=named_quality(options.quality),
        command=worker_command(options.cache_dir, options.blender_python),
        cache_dir=options.cache_dir,
        viewpoints=options.viewpoint,
        progress=_report,
    )
    for one in baked:
        missing = ", ".join(one.uncovered) or "nothing"
        _say(f"{one.folder}: {one.weight_bytes / 1e6:.2f} MB, {one.tiles} tiles, not in tiles: {missing}")


def _verify(options: argparse.Namespace) -> None:
    scene = Scene(options.out)
    with BlenderWorker(worker_command(options.cache_dir, options.blender_python), options.cache_dir / "verify.log") as worker:
        worker.request("load_scene", {"source": options.scene})
        poses = draw_poses(scene, options.seed, options.wide, options.zoomed, options.viewpoint)
        for r in verify(scene, worker, poses, _report):
            boxes = "no boxes" if r.box_iou is None else f"box IoU {r.box_iou:.3f}"
            _say(
                f"{r.viewpoint} pan {r.pose.pan_deg:.1f} tilt {r.pose.tilt_deg:.1f} zoom {r.pose.zoom:.2f}: SSIM {r.ssim:.3f}, "
                f"sharpness {r.sharpness_ratio:.2f}, {boxes}, in tiles {r.tile_share:.0%}"
            )


def _report(part: str, done: int, total: int, seconds: float) -> None:
    _say(f"{part} {done}/{total} {seconds:.0f} s")


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()

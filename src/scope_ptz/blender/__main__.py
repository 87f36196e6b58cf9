"""``python -m scope_ptz.blender bake SCENE``: the bake without the rest of the command line."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from scope_ptz.blender.bake import bake
from scope_ptz.blender.environment import worker_command
from scope_ptz.blender.quality import QUALITIES
from scope_ptz.settings import load_settings


def main() -> None:
    settings = load_settings()
    parser = argparse.ArgumentParser(prog="python -m scope_ptz.blender")
    parser.add_argument("operation", choices=["bake"])
    parser.add_argument("scene")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--quality", choices=sorted(QUALITIES), default="standard")
    parser.add_argument("--viewpoint", action="append")
    parser.add_argument("--blender-python", type=Path, default=settings.blender_python)
    parser.add_argument("--cache-dir", type=Path, default=settings.cache_dir)
    options = parser.parse_args()
    baked = bake(
        options.scene,
        options.out,
        quality=options.quality,
        command=worker_command(options.cache_dir, options.blender_python),
        cache_dir=options.cache_dir,
        viewpoints=options.viewpoint,
        progress=_report,
    )
    for one in baked:
        missing = ", ".join(one.uncovered) or "nothing"
        sys.stdout.write(f"{one.folder}: {one.weight_bytes / 1e6:.2f} MB, {one.tiles} tiles, not in tiles: {missing}\n")


def _report(part: str, done: int, total: int, seconds: float) -> None:
    sys.stdout.write(f"{part} {done}/{total} {seconds:.0f} s\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()

"""The Python environment that runs Blender: the user's own, or one with the ``bpy`` wheel that is created on demand.

The wheel needs Python 3.11 and NumPy 1, so it never shares an environment with the main program.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from scope_ptz.blender.sources import studio_folder
from scope_ptz.errors import BlenderError

BPY_VERSION = "5.0.1"
REQUIREMENTS = (f"bpy=={BPY_VERSION}", "numpy>=1.26,<2", "OpenEXR>=3.3,<4")
PYTHON_VERSION = "3.11"
READY = "ready"  # name of the file that marks a complete environment


def worker_command(cache_dir: Path, blender_python: Path | None = None) -> list[str]:
    """Return the command that starts the worker.

    Args:
        cache_dir: The folder for the environment. The first call creates it, which downloads about 400 MB.
        blender_python: A Python that can import ``bpy``, or the ``blender`` program, to use instead of the environment.

    Raises:
        BlenderError: There is no such program, or the environment cannot be created.
    """
    script = str(studio_folder() / "worker.py")
    if blender_python is None:
        return [str(ensure_environment(cache_dir)), script]
    program = shutil.which(str(blender_python))
    if program is None:
        raise BlenderError(f"There is no program '{blender_python}'. Specify a Python that can import bpy, or the blender program.")
    if Path(program).name.lower().startswith("blender"):
        return [program, "--background", "--factory-startup", "--python-exit-code", "1", "--python", script]
    return [program, script]


def environment_python(cache_dir: Path) -> Path:
    """Return the path to the environment's Python, which may not exist yet."""
    folder = cache_dir / f"blender-{BPY_VERSION}"
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def is_ready(cache_dir: Path) -> bool:
    """Return whether the environment is complete."""
    return (cache_dir / f"blender-{BPY_VERSION}" / READY).exists()


def ensure_environment(cache_dir: Path) -> Path:
    """Create the environment if it is missing or incomplete, and return the path to its Python.

    Raises:
        BlenderError: The environment cannot be created.
    """
    python = environment_python(cache_dir)
    if is_ready(cache_dir):
        return python
    folder = python.parents[1]
    shutil.rmtree(folder, ignore_errors=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    uv = shutil.which("uv")
    if uv is not None:
        _run([uv, "venv", "--quiet", "--python", PYTHON_VERSION, str(folder)])
        _run([uv, "pip", "install", "--quiet", "--python", str(python), *REQUIREMENTS])
    else:
        _run([_python311(), "-m", "venv", str(folder)])
        _run([str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *REQUIREMENTS])
    (folder / READY).write_text("\n".join(REQUIREMENTS) + "\n")
    return python


def _python311() -> str:
    if sys.version_info[:2] == (3, 11):
        return sys.executable
    found = shutil.which(f"python{PYTHON_VERSION}")
    if found is None:
        raise BlenderError(f"Blender's Python module needs Python {PYTHON_VERSION}. Install it, or install uv, which downloads it.")
    return found


def _run(command: list[str]) -> None:
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        tail = "\n".join((result.stderr or result.stdout).strip().splitlines()[-8:])
        raise BlenderError(f"Blender's environment could not be created: `{' '.join(command)}` failed.\n{tail}")

"""Where Blender comes from: the user's own, or the ``bpy`` wheel in an environment made on demand.

The wheel wants Python 3.11 and NumPy 1, which is why it never shares an environment with the main program.
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
READY = "ready"


def worker_command(cache_dir: Path, blender_python: Path | None = None) -> list[str]:
    """The command that starts the worker.

    ``blender_python`` is the user's choice: a Python that can import ``bpy``, or the ``blender`` program itself. Without it the
    environment under ``cache_dir`` is used, and made first when it does not exist (a download of about 400 MB).
    """
    script = str(studio_folder() / "worker.py")
    if blender_python is None:
        return [str(ensure_environment(cache_dir)), script]
    program = shutil.which(str(blender_python))
    if program is None:
        raise BlenderError(f"There is no program '{blender_python}': name a Python that has bpy, or Blender itself.")
    if Path(program).name.lower().startswith("blender"):
        return [program, "--background", "--factory-startup", "--python-exit-code", "1", "--python", script]
    return [program, script]


def environment_python(cache_dir: Path) -> Path:
    """The Python of the environment, whether it exists or not."""
    folder = cache_dir / f"blender-{BPY_VERSION}"
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def is_ready(cache_dir: Path) -> bool:
    """Whether the environment was made to the end."""
    return (cache_dir / f"blender-{BPY_VERSION}" / READY).exists()


def ensure_environment(cache_dir: Path) -> Path:
    """Make the environment if it is missing or half made; returns its Python."""
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
        raise BlenderError(f"Blender's Python module needs Python {PYTHON_VERSION}: install it, or uv, which fetches it.")
    return found


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        tail = "\n".join((done.stderr or done.stdout).strip().splitlines()[-8:])
        raise BlenderError(f"Blender's environment could not be made: `{' '.join(command)}` failed.\n{tail}")

"""The worker process inside Blender. It reads requests from stdin and writes replies, both as JSON lines.

Run this file by its path, either with a Python that has ``bpy`` or as ``blender --background --python worker.py``. Every reply
starts with ``REPLY_PREFIX``, because Blender prints to stdout while it starts. Its later output goes to stderr.
"""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

REPLY_PREFIX = "@scope "


def register_packages() -> None:
    """Make ``scope_studio`` and ``scope_ptz`` importable without adding their parent folder to ``sys.path``.

    The parent folder is not added because it may contain packages that conflict with Blender's packages, such as another version of
    NumPy. The packages' ``__init__`` modules are not executed, because that of ``scope_ptz`` imports packages that Blender's Python
    does not have. The worker needs only ``scope_ptz.geometry``.
    """
    for name in ("scope_studio", "scope_ptz"):
        home = Path(__file__).resolve().parents[1] / name
        if not home.is_dir():
            raise ImportError(f"the package folder {home} does not exist; reinstall scope-ptz")
        module = ModuleType(name)
        module.__path__ = [str(home)]
        sys.modules[name] = module


class Channel:
    """The worker's end of the pipe to the main program."""

    def __init__(self) -> None:
        self._out = os.fdopen(os.dup(1), "w", encoding="utf-8")
        os.dup2(2, 1)
        self._in = sys.stdin
        self._number = 0

    def send(self, message: dict[str, Any]) -> None:
        """Write one message as a marked JSON line."""
        self._out.write(f"{REPLY_PREFIX}{json.dumps(message)}\n")
        self._out.flush()

    def serve(self, operations: dict[str, Callable[..., Any]]) -> None:
        """Execute requests and send their results, until the pipe closes or a "quit" request arrives."""
        for line in self._in:
            request = json.loads(line)
            if request["op"] == "quit":
                return
            self._number = request["id"]
            try:
                result = operations[request["op"]](**request["params"])
            except Exception as error:  # report every failure in Blender to the caller
                traceback.print_exc()
                self.send({"id": self._number, "error": f"{type(error).__name__}: {error}"})
            else:
                self.send({"id": self._number, "result": result})

    def progress(self, done: int, total: int) -> None:
        """Send the number of finished steps of the current operation."""
        self.send({"id": self._number, "progress": [done, total]})


def main() -> None:
    """Send the Blender version, then serve requests."""
    channel = Channel()
    import bpy

    from scope_studio.operations import operations

    channel.send({"hello": bpy.app.version_string})
    channel.serve(operations(channel.progress))


if __name__ == "__main__":
    folder = str(Path(__file__).resolve().parent)
    sys.path[:] = [p for p in sys.path if p != folder]
    register_packages()
    from scope_studio.worker import main as package_main

    package_main()
    os._exit(0)  # Blender's teardown can hang or crash, and nothing is left to save

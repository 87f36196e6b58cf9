"""Starting sooner: without the garbage collector, and without what help pages do not need."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType
from typing import Any

_HELP_OPTIONS = {"-h", "--help"}
_LATE = {"rich.markdown": "Markdown", "rich.traceback": "Traceback"}


@contextmanager
def collector_paused() -> Iterator[None]:
    """Pause the garbage collector while modules are imported.

    Imports make many objects and no garbage, so that looking for garbage among them only takes time: a tenth of ``scope ask``.
    """
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def prepare_help(arguments: list[str]) -> None:
    """Import what draws help pages, if help is requested.

    Typer also imports Rich's Markdown and tracebacks, which help pages do not use and which take half of the time of
    ``scope --help``. They are imported on first use.
    """
    if arguments and _HELP_OPTIONS.isdisjoint(arguments):
        return
    late = {module: _late_module(module, name) for module, name in _LATE.items() if module not in sys.modules}
    sys.modules.update(late)
    try:
        import_module("typer.rich_utils")
    finally:
        for module in late:
            del sys.modules[module]


def _late_module(module: str, name: str) -> ModuleType:
    """Return a module whose only class imports the real module when an object is made."""

    def make(cls: type, *args: Any, **kwargs: Any) -> Any:  # noqa: ARG001 - the signature of __new__
        return getattr(import_module(module), name)(*args, **kwargs)

    stand_in = ModuleType(module)
    setattr(stand_in, name, type(name, (), {"__new__": make}))
    return stand_in

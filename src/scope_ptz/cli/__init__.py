"""The command line ``scope``. It starts fast: help imports little, and each command imports what it needs when it runs."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType
from typing import Any

_HELP_OPTIONS = {"-h", "--help"}
_DEFERRED_CLASSES = {"rich.markdown": "Markdown", "rich.traceback": "Traceback"}


def main() -> None:
    """Run ``scope``. This is the entry point of the installed program."""
    from scope_ptz.cli.exit import decode_arguments, safe_streams

    # Disable pydantic's plug-ins: the command line uses none, and searching for them reads the metadata of every installed package.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    with safe_streams():
        with pause_garbage_collection():
            from scope_ptz.cli.app import app

            sys.argv[1:] = decode_arguments(sys.argv[1:])
            prepare_help(sys.argv[1:])
        app(prog_name="scope")


@contextmanager
def pause_garbage_collection() -> Iterator[None]:
    """Pause the garbage collector while modules are imported.

    Imports create many objects but hardly any garbage, so garbage collection during imports is useless. It would take a tenth of
    the run time of ``scope ask``.
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
    """Import the modules that render help pages, if help is requested.

    Typer also imports Rich's modules for Markdown and tracebacks. Help pages do not use these modules, but importing them takes
    half the run time of ``scope --help``, so they are imported on first use.
    """
    if arguments and _HELP_OPTIONS.isdisjoint(arguments):
        return
    deferred = {module: _deferred_module(module, name) for module, name in _DEFERRED_CLASSES.items() if module not in sys.modules}
    sys.modules.update(deferred)
    try:
        import_module("typer.rich_utils")
    finally:
        for module in deferred:
            del sys.modules[module]


def _deferred_module(module: str, name: str) -> ModuleType:
    """Return a module whose only class imports the real module when it is instantiated."""

    def make(cls: type, *args: Any, **kwargs: Any) -> Any:  # noqa: ARG001 - the signature of __new__
        return getattr(import_module(module), name)(*args, **kwargs)

    proxy = ModuleType(module)
    setattr(proxy, name, type(name, (), {"__new__": make}))
    return proxy

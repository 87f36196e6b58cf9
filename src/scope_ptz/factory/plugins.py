"""Plug-ins: cameras, planners and perception backends that other installed packages provide.

A package declares a factory function as an entry point in one of three groups:

========================  ==========================  ==================================================
group                     name                        factory
========================  ==========================  ==================================================
``scope_ptz.cameras``     scheme of the camera spec   ``CameraSpec -> Camera``, plain or async
``scope_ptz.planners``    value of ``--planner``      ``PlannerSpec -> Planner``
``scope_ptz.perception``  value of ``--perception``   ``BackendSpec -> Perception``
========================  ==========================  ==================================================

Built-in names and names in the model registry take precedence over plug-ins with the same name. A plug-in is imported only when
it is used or checked, so a broken plug-in does not affect other commands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from scope_ptz.entry_points import CAMERAS, PERCEPTION, PLANNERS, InstalledEntry, duplicated_names, installed, normalised

Kind = Literal["camera", "planner", "perception"]
GROUPS: dict[Kind, str] = {"camera": CAMERAS, "planner": PLANNERS, "perception": PERCEPTION}


@dataclass(frozen=True, slots=True)
class Plugin:
    """An installed plug-in, which is imported on first use.

    Attributes:
        kind: Whether it provides a camera, a planner or a perception backend.
        name: The name that selects it.
        package: Name and version of the distribution.
        target: The factory, as ``module:attribute``.
        problem: The reason why the name does not select this plug-in; empty if it does.
        entry: The entry point.
    """

    kind: Kind
    name: str
    package: str
    target: str
    problem: str
    entry: InstalledEntry


def list_plugins() -> tuple[Plugin, ...]:
    """Return all installed plug-ins, sorted by kind and name, without importing them."""
    return tuple(plugin for kind in GROUPS for plugin in list_plugins_of_kind(kind))


def list_plugins_of_kind(kind: Kind) -> tuple[Plugin, ...]:
    """Return the installed plug-ins of one kind, sorted by name, without importing them."""
    group = GROUPS[kind]
    entries = installed(group)
    if not entries:
        return ()
    reserved, duplicates = _reserved_names(kind), duplicated_names(group)
    return tuple(
        Plugin(kind, entry.name, entry.package, entry.target, _problem(entry, kind, reserved, duplicates), entry)
        for entry in entries
    )


def _problem(entry: InstalledEntry, kind: Kind, reserved: frozenset[str], duplicates: frozenset[str]) -> str:
    if entry.name in reserved:
        return f"a built-in {kind} has the same name and is used instead. Rename the entry point"
    if entry.name in duplicates:
        return "another package provides a plug-in with the same name. Uninstall one of the packages"
    return ""


def _reserved_names(kind: Kind) -> frozenset[str]:
    """Return the built-in names and the names in the model registry, which plug-ins cannot use."""
    if kind == "camera":
        from scope_ptz.factory.cameras import BUILT_IN_SCHEMES

        return frozenset(BUILT_IN_SCHEMES)
    from scope_ptz.builtin_names import BUILT_IN_PERCEPTION, CHAT, GRAMMAR
    from scope_ptz.registry import load_registry
    from scope_ptz.settings import load_settings

    registered = load_registry(load_settings().models_file()).model_names(kind)
    if kind == "planner":
        names = {GRAMMAR, CHAT, *registered}
    else:
        from scope_ptz.perception.backends import built_in_backends

        names = {*BUILT_IN_PERCEPTION, *registered, *built_in_backends()}
    return frozenset(normalised(name) for name in names)

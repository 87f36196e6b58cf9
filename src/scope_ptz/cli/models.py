"""``scope models``: list models with their memory requirements, pairs and plug-ins, and print the commands that serve a model."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from scope_ptz.cli.display import sanitize
from scope_ptz.cli.exit import put, put_json
from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.registry import Model, Registry, Role, load_registry
from scope_ptz.registry.model_entries import RUNTIME_GB, WINDOW
from scope_ptz.settings import load_settings

MEMORY_NOTE = (
    f"Memory in GB, computed, not measured: parameters x bytes + cache for {WINDOW} tokens + {RUNTIME_GB:g} GB. "
    "'from': the memory that the smallest available weights need, usually 4-bit."
)
_WIDE_TABLE_WIDTH, _PIPE_WIDTH = 120, 180  # minimum terminal width for the wide table, and the width for a file or a pipe
_THINKING = {"none": "no", "optional": "when asked", "default": "unless switched off", "always": "always"}


def load_model_registry() -> Registry:
    """Load the registry with the built-in models and the user's models."""
    return load_registry(load_settings().models_file())


def list_models(role: str | None, memory_gb: float | None, *, as_json: bool) -> None:
    """Print the models.

    Args:
        role: Role of the models to list; None for all roles.
        memory_gb: Maximum memory of the models to list, in GB. A line below the table names models that fit with smaller weights.
        as_json: Print JSON instead of a table.
    """
    registry, requested_role = load_model_registry(), _parse_role(role)
    with_role = [m for m in registry.models.values() if requested_role is None or requested_role in m.roles]
    listed = [m for m in with_role if memory_gb is None or m.memory_for() <= memory_gb]
    if as_json:
        put_json([model_data(registry, model) for model in listed], indent=2)
        return
    console = _console()
    wide = console.width >= _WIDE_TABLE_WIDTH
    table = Table(box=None)
    for column in (
        "name",
        "role",
        "size",
        "active",
        "precision",
        "memory",
        "from",
        "context",
        *(("thinks", "licence") if wide else ()),
    ):
        table.add_column(column, no_wrap=True)
    for model in listed:
        roles, (_, min_memory_gb) = "+".join(sorted(model.roles, reverse=True)), model.min_memory_server()
        extra_cells = (_THINKING[model.thinking], model.licence) if wide else ()
        table.add_row(
            model.name, roles, f"{model.size_b:g}B", f"{model.active_b:g}B", model.precision, f"{model.memory_for():.1f}",
            f"{min_memory_gb:.1f}", f"{model.context:,}" if model.context else "-", *extra_cells,
            style="bold" if model.origin == "paper" else "",
        )  # fmt: skip
    console.print(table)
    if memory_gb is not None:
        fitting_when_smaller = [m for m in with_role if m not in listed and m.min_memory_server()[1] <= memory_gb]
        if fitting_when_smaller:
            names = ", ".join(f"{m.name} ({m.min_memory_server()[1]:.1f} GB)" for m in fitting_when_smaller)
            console.print(Text(f"With smaller weights, {memory_gb:g} GB is enough for: {names}."), soft_wrap=True)
    console.print(Text(MEMORY_NOTE, style="dim"), soft_wrap=True)
    _print_plugin_names(console, requested_role)
    if console.is_terminal:
        console.print(Text("Bold: models of the paper. More: `scope models show NAME`, `scope models pairs`.", style="dim"))


def list_plugins(*, as_json: bool) -> None:
    """Print the installed plug-ins: cameras, planners and perception backends from other packages."""
    from scope_ptz.factory.plugins import list_plugins as installed

    rows = [{"kind": p.kind, "name": p.name, "package": p.package, "factory": p.target, "problem": p.problem} for p in installed()]
    if as_json:
        put_json(rows, indent=2)
        return
    if not rows:
        put("No plug-ins are installed. docs/how-to/plugins.md shows how to add cameras, planners and perception backends.")
        return
    table = Table("kind", "name", "package", "factory", "problem", box=None)
    for row in rows:
        table.add_row(*(sanitize(value) for value in row.values()))
    _console().print(table)


def _print_plugin_names(console: Console, role: Role | None) -> None:
    """Print the names of the plug-ins that can be used like the listed models."""
    from scope_ptz.factory.plugins import list_plugins_of_kind

    for kind in ("planner", "perception") if role is None else (role,):
        names = [f"{plugin.name} ({plugin.package})" for plugin in list_plugins_of_kind(kind) if not plugin.problem]
        if names:
            console.print(Text(sanitize(f"Plug-ins for --{kind}: {', '.join(names)}")), soft_wrap=True)


def show_model(name: str, *, as_json: bool) -> None:
    """Print all registry data about a model."""
    registry = load_model_registry()
    model = registry.model(name)
    if as_json:
        put_json(model_data(registry, model), indent=2)
        return
    put(f"{model.title} ({model.name})")
    facts = [
        ("repository", model.repo + (f" at {model.revision}" if model.revision else "")),
        ("role", " and ".join(model.roles) + (", accepts pictures in the chat" if model.sees else "")),
        ("from", {"paper": "the paper", "current": "added by SCOPE", "yours": "your models file"}[model.origin]),
        ("size", f"{model.size_b:g}B parameters, {model.active_b:g}B active"),
        ("precision", model.precision),
        ("context", f"{model.context:,} tokens" if model.context else "-"),
        ("thinks", _THINKING[model.thinking]),
        ("coordinates", model.coordinates),
        ("licence", model.licence),
        ("memory", f"{model.memory_for():.1f} GB at {model.precision}"),
        ("address", model.url),
        ("notes", model.notes),
        ("source", model.source),
    ]
    for label, value in facts:
        if value:
            put(f"  {label:12}{sanitize(value)}")
    for server in model.serve:
        _show_serving(registry, model, server)
    put(MEMORY_NOTE)


def _show_serving(registry: Registry, model: Model, server: str) -> None:
    serving = model.serve[server]
    put(
        f"  with {registry.server(server).title} ({server}): {model.memory_for(server):.1f} GB, "
        f"{serving.precision or model.precision}"
    )
    for line in registry.commands(model, server):
        put(f"      {line}")
    for note in (serving.notes, registry.server(server).notes):
        if note:
            put(f"      # {note}")


def serve_command(name: str, server: str | None) -> None:
    """Print only the commands for serving a model, so that a shell can run the output."""
    registry = load_model_registry()
    model = registry.model(name)
    if server is None:
        if not model.serve:
            raise ConfigError(f"No server is known for {model.name}. Add one under `serve` in your models file.")
        server = next(iter(model.serve))
    for line in registry.commands(model, server):
        put(line)


def list_pairs(*, as_json: bool) -> None:
    """Print the known pairs of planner and perception models."""
    registry = load_model_registry()
    rows = [
        {
            "name": p.name, "planner": p.planner, "perception": p.perception, "origin": p.origin, "paper_average": p.paper_average,
            "memory_gb": round(registry.model(p.planner).memory_for() + registry.model(p.perception).memory_for(), 1),
        }
        for p in registry.pairs.values()
    ]  # fmt: skip
    if as_json:
        put_json(rows, indent=2)
        return
    table = Table("pair", "memory", "paper's average", box=None)
    for row in rows:
        average = row["paper_average"]
        table.add_row(str(row["name"]), f"{row['memory_gb']:.1f}", f"{average:.1f} %" if average is not None else "-")
    console = _console()
    console.print(table)
    console.print(Text("Averages are the paper's (macro average over its eight categories), not measured here.", style="dim"))
    console.print(Text("Any PLANNER+PERCEPTION of `scope models` works, and so does one model that does both.", style="dim"))


def model_data(registry: Registry, model: Model) -> dict[str, Any]:
    """Return a model as JSON data, including the memory and commands for each server."""
    data = model.model_dump(mode="json", exclude={"serve", "key_file", "memory_gb", "kv_kib"})
    servings = {
        server: {
            "commands": list(registry.commands(model, server)),
            "url": registry.server(server).url,
            "precision": serving.precision or model.precision,
            "memory_gb": model.memory_for(server),
            "notes": serving.notes,
        }
        for server, serving in model.serve.items()
    }
    return {**data, "memory_gb": model.memory_for(), "least_memory_gb": model.min_memory_server()[1], "serve": servings}


def _console() -> Console:
    """Return a console that is as wide as the terminal, or wide enough for the table if the output is a file or a pipe."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=_PIPE_WIDTH)


def _parse_role(role: str | None) -> Role | None:
    match role:
        case None | "planner" | "perception":
            return role
        case _:
            raise UnknownNameError("role", role, ("planner", "perception"))

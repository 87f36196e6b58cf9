"""The commands about the benchmark."""

from __future__ import annotations

import typer

from scope_ptz.cli.endings import ending

bench_app = typer.Typer(help="The benchmark: its tasks and how they are checked.", no_args_is_help=True)


@bench_app.callback()
def bench() -> None:
    """The benchmark: its tasks and how they are checked."""


@bench_app.command("schema")
def schema() -> None:
    """Print the JSON schema of a task."""
    with ending():
        from scope_ptz.bench.tasks import schema as task_schema
        from scope_ptz.cli.endings import put_json

        put_json(task_schema(), indent=2)

"""The commands about the benchmark."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from scope_ptz.cli.bench_agree import agree
from scope_ptz.cli.bench_audit import audit_app
from scope_ptz.cli.bench_browse import browse
from scope_ptz.cli.bench_build import build
from scope_ptz.cli.bench_card import card
from scope_ptz.cli.bench_gate import gate
from scope_ptz.cli.bench_generate import generate
from scope_ptz.cli.bench_gold import gold_app
from scope_ptz.cli.bench_human import human
from scope_ptz.cli.bench_import import import_tasks
from scope_ptz.cli.bench_inputs import TasksOption
from scope_ptz.cli.bench_judge_gold import judge_gold
from scope_ptz.cli.bench_label import label
from scope_ptz.cli.bench_reporting import report, submission_app
from scope_ptz.cli.bench_rescore import rescore
from scope_ptz.cli.bench_run import run
from scope_ptz.cli.bench_sweep import sweep
from scope_ptz.cli.endings import FAILED, ending, put, put_json

bench_app = typer.Typer(help="The benchmark: its tasks and how they are checked.", no_args_is_help=True)


@bench_app.callback()
def bench() -> None:
    """The benchmark: its tasks and how they are checked."""


@bench_app.command("schema")
def schema() -> None:
    """Print the JSON schema of a task."""
    with ending():
        from scope_ptz.bench.tasks.task import schema as task_schema

        put_json(task_schema(), indent=2)


bench_app.command("run")(run)
bench_app.command("sweep")(sweep)
bench_app.command("rescore")(rescore)
bench_app.command("gate")(gate)
bench_app.command("build")(build)
bench_app.command("browse")(browse)
bench_app.command("card")(card)
bench_app.command("human")(human)
bench_app.command("generate")(generate)
bench_app.command("agree")(agree)
bench_app.command("label")(label)
bench_app.command("report")(report)
bench_app.add_typer(submission_app, name="submission")
bench_app.command("judge-gold")(judge_gold)
bench_app.command("import")(import_tasks)
bench_app.add_typer(gold_app, name="gold")
bench_app.add_typer(audit_app, name="audit")


@bench_app.command("validate")
def validate(
    tasks: TasksOption = "all",
    as_json: Annotated[bool, typer.Option("--json", help="The whole report as JSON.")] = False,
    seed: Annotated[int, typer.Option(help="For the wrong answers that are tried.")] = 1,
) -> None:
    """Prove the tasks: right programs and answers pass, cheats do not. Exit code 1 on any failure."""
    with ending(as_json=as_json):
        from scope_ptz.bench.tasks.splits import load_split
        from scope_ptz.cli.bench_proof import prove
        from scope_ptz.cli.bench_report import report_lines

        report = prove(load_split(tasks), seed, beside=load_split("core") if tasks in ("lite", "paraphrase") else ())
        if as_json:
            put_json(report.as_dict())
        else:
            for line in report_lines(report):
                put(line)
        if not report.sound:
            sys.exit(FAILED)

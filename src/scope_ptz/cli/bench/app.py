"""The ``scope bench`` app, with its commands grouped as in the help."""

from __future__ import annotations

import typer

from scope_ptz.cli.bench import HELP
from scope_ptz.cli.bench.audit import audit_app
from scope_ptz.cli.bench.browse import browse
from scope_ptz.cli.bench.build import build, card, gold_app, validate
from scope_ptz.cli.bench.drafts import drafts
from scope_ptz.cli.bench.generate import generate, import_tasks
from scope_ptz.cli.bench.host import host, keygen
from scope_ptz.cli.bench.human import human
from scope_ptz.cli.bench.judge import agree, judge_gold, rescore
from scope_ptz.cli.bench.label import label
from scope_ptz.cli.bench.leaderboard import leaderboard
from scope_ptz.cli.bench.report import gate, report, submission_app
from scope_ptz.cli.bench.run import run
from scope_ptz.cli.bench.sweep import sweep
from scope_ptz.cli.bench.verify import verify
from scope_ptz.cli.exit import put_json
from scope_ptz.cli.options import command

START, RUN, SCORES, TASKS, SHARE = "Start here", "Run", "Scores and judges", "Make tasks", "Share"

bench_app = typer.Typer(help=HELP, no_args_is_help=True)


@bench_app.callback(help=HELP)
def _bench() -> None:
    """Define the group of benchmark commands."""


def schema() -> None:
    """Print the JSON schema of a task."""
    from scope_ptz.bench.tasks.task import schema as task_schema

    put_json(task_schema(), indent=2)


for panel, name, function in (
    (START, "browse", browse),
    (START, "run", run),
    (START, "report", report),
    (RUN, "sweep", sweep),
    (RUN, "human", human),
    (RUN, "gate", gate),
    (SCORES, "rescore", rescore),
    (SCORES, "verify", verify),
    (SCORES, "label", label),
    (SCORES, "agree", agree),
    (SCORES, "judge-gold", judge_gold),
    (TASKS, "build", build),
    (TASKS, "generate", generate),
    (TASKS, "drafts", drafts),
    (TASKS, "import", import_tasks),
    (TASKS, "validate", validate),
    (TASKS, "card", card),
    (TASKS, "schema", schema),
    (SHARE, "host", host),
    (SHARE, "keygen", keygen),
    (SHARE, "leaderboard", leaderboard),
):
    bench_app.command(name, rich_help_panel=panel)(command(function))

bench_app.add_typer(gold_app, name="gold", rich_help_panel=TASKS)
bench_app.add_typer(audit_app, name="audit", rich_help_panel=TASKS)
bench_app.add_typer(submission_app, name="submission", rich_help_panel=SHARE)

"""The ``scope bench`` commands, grouped as in the help. They are imported when one of them is used or listed."""

from __future__ import annotations

import typer

from scope_ptz.cli.typer_extensions import LazyGroup, command

HELP = """Measure planners and perception on 536 tasks.

Start with `scope bench browse` to see tasks, and `scope bench run --split lite` for a first score without any model.
"""
START, RUN, SCORES, TASKS, SHARE = "Start here", "Run", "Scores and judges", "Make tasks", "Share"


class BenchGroup(LazyGroup):
    """The benchmark commands."""

    def load_app(self) -> typer.Typer:
        from scope_ptz.cli.bench.browse import audit_app, browse
        from scope_ptz.cli.bench.build import build, card, gold_app, schema, validate
        from scope_ptz.cli.bench.generate import drafts, generate, import_tasks
        from scope_ptz.cli.bench.host import host, keygen
        from scope_ptz.cli.bench.human import human
        from scope_ptz.cli.bench.judge import agree, judge_gold, rescore
        from scope_ptz.cli.bench.label import label
        from scope_ptz.cli.bench.report import gate, leaderboard, report, submission_app
        from scope_ptz.cli.bench.run import run, sweep
        from scope_ptz.cli.bench.verify import verify

        bench_app = typer.Typer()
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
        return bench_app

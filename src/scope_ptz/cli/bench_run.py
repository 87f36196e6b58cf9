"""``scope bench run``: an evaluation, its table, and going on with one that was broken off."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli import model_options as models
from scope_ptz.cli.bench_judge import TIMEOUT_S, JudgeKey, JudgeModel, JudgeOption, JudgeTimeout, JudgeUrl
from scope_ptz.cli.endings import FAILED, ending, put, put_json
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.bench.engine.estimate import Price
    from scope_ptz.bench.scoring.trials import Evaluation
    from scope_ptz.cli.bench_judged import Ended

TASKS_PANEL, RUN_PANEL = "Tasks", "Running"
LOGS = Path("evaluations")

SplitOption = Annotated[
    str,
    typer.Option(
        "--split", "--tasks", help="core, lite, paraphrase, reaction, unseen, all, or a task file.", rich_help_panel=TASKS_PANEL
    ),
]
CategoryOption = Annotated[
    list[str] | None, typer.Option("--category", help="Only this category; may be given again.", rich_help_panel=TASKS_PANEL)
]
SceneOption = Annotated[
    list[str] | None, typer.Option("--scene", help="Only this scene; may be given again.", rich_help_panel=TASKS_PANEL)
]
LimitOption = Annotated[
    int | None, typer.Option("--limit", min=1, help="So many tasks, spread over what is chosen.", rich_help_panel=TASKS_PANEL)
]
EpochsOption = Annotated[int, typer.Option("--epochs", min=1, help="How often each task is run.", rich_help_panel=TASKS_PANEL)]
ConcurrencyOption = Annotated[
    int | None,
    typer.Option(
        "--concurrency", min=1, max=256, help="Runs at a time (default: what suits the models).", rich_help_panel=RUN_PANEL
    ),
]
LatencyOption = Annotated[
    bool, typer.Option("--latency", help="One run at a time, so that latencies are the pair's own.", rich_help_panel=RUN_PANEL)
]
SeedOption = Annotated[int, typer.Option("--seed", help="Of everything random.", rich_help_panel=RUN_PANEL)]
StepsOption = Annotated[int, typer.Option("--max-steps", min=1, help="Planner steps of a run.", rich_help_panel=RUN_PANEL)]
TimeOption = Annotated[
    float | None, typer.Option("--time-budget", min=1, help="Seconds that a run may take.", rich_help_panel=RUN_PANEL)
]
PicturesOption = Annotated[
    bool,
    typer.Option(
        "--pictures/--no-pictures",
        help="Draw and log what the camera shows; ground-truth eyes need none.",
        rich_help_panel=RUN_PANEL,
    ),
]
OutOption = Annotated[Path, typer.Option("--out", help="Folder of the logs.", rich_help_panel=RUN_PANEL)]
PriceOption = Annotated[
    str | None,
    typer.Option("--price", metavar="IN,OUT", help="US dollars per million planner tokens.", rich_help_panel=RUN_PANEL),
]
AgentOption = Annotated[
    str,
    typer.Option(
        "--agent",
        metavar="MODULE:CLASS",
        help="Another agent in place of our loop; see docs/evaluation.md.",
        rich_help_panel="Models",
    ),
]


def run(
    split: SplitOption = "core",
    category: CategoryOption = None,
    scene: SceneOption = None,
    limit: LimitOption = None,
    epochs: EpochsOption = 1,
    concurrency: ConcurrencyOption = None,
    latency: LatencyOption = False,
    seed: SeedOption = 1,
    max_steps: StepsOption = 60,
    time_budget: TimeOption = None,
    pictures: PicturesOption = True,
    out: OutOption = LOGS,
    resume: Annotated[
        Path | None,
        typer.Option(
            "--resume", metavar="LOG", help="Go on with this log (default: with the one in --out).", rich_help_panel=RUN_PANEL
        ),
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Begin again, whatever logs there are.", rich_help_panel=RUN_PANEL)
    ] = False,
    variant: Annotated[
        str, typer.Option("--variant", help="A label, for runs that differ by one setting.", rich_help_panel=RUN_PANEL)
    ] = "",
    price: PriceOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object at the end.")] = False,
    agent: AgentOption = "scope",
    judge_url: JudgeUrl = None,
    judge_model: JudgeModel = None,
    judge_key_file: JudgeKey = None,
    judge_timeout: JudgeTimeout = TIMEOUT_S,
    judge_option: JudgeOption = None,
    judge_repeats: Annotated[
        int, typer.Option("--judge-repeats", min=1, help="Judgements of each run.", rich_help_panel="Judge")
    ] = 1,
    planner: models.PlannerOption = None,
    perception: models.PerceptionOption = None,
    pair: models.PairOption = None,
    planner_url: models.PlannerUrlOption = None,
    perception_url: models.PerceptionUrlOption = None,
    planner_model: models.PlannerModelOption = None,
    perception_model: models.PerceptionModelOption = None,
    planner_key_file: models.PlannerKeyOption = None,
    perception_key_file: models.PerceptionKeyOption = None,
    planner_option: models.PlannerOptions = None,
    perception_option: models.PerceptionOptions = None,
    reader: models.ReaderOption = None,
    detector: models.DetectorOption = None,
    timeout: models.TimeoutOption = None,
) -> None:
    """Run a pair, or another agent, on the benchmark. The same command goes on where a broken-off one stopped.

    Without options: the built-in planner and ground-truth eyes on the published tasks, here, without any key.
    """
    with ending(as_json=as_json):
        import anyio
        from rich.console import Console

        from scope_ptz.cli.bench_evaluate import RunOptions, evaluate, need_engine
        from scope_ptz.cli.bench_judged import JudgeOptions
        from scope_ptz.cli.bench_live import summary
        from scope_ptz.settings import load_settings

        need_engine()
        wishes = models.model_options(
            planner, perception, pair, planner_url, perception_url, planner_model, perception_model, planner_key_file, perception_key_file,
            planner_option, perception_option, reader, detector, timeout,
        )  # fmt: skip
        with_judge = bool(judge_url or judge_model or load_settings().judge_url)
        judge = JudgeOptions(judge_url, judge_model, judge_key_file, judge_timeout, tuple(judge_option or ()), judge_repeats)
        options = RunOptions(
            wishes=wishes, out=out, tasks=split, categories=tuple(category or ()), scenes=tuple(scene or ()), limit=limit,
            epochs=epochs, seed=seed, agent=agent, max_steps=max_steps, time_s=time_budget, concurrency=concurrency,
            latency=latency, pictures=pictures, variant=variant, fresh=fresh, resume=resume, price=price_of(price),
            judge=judge if with_judge else None,
        )  # fmt: skip
        console = Console(highlight=False, stderr=as_json)
        ended = anyio.run(evaluate, options, console)
        evaluation, judged = ended.evaluation, ended.judged
        if as_json:
            asked = {"judge": ended.judge, "judgements": asdict(judged)} if judged is not None else {}
            put_json(result(evaluation) | asked)
        else:
            console.print(summary(evaluation))
            if judged is not None:
                put(f"judge      {ended.judge}: {judged.summary}")
            put(f"log        {evaluation.log}")
        finish(ended)


def finish(ended: Ended) -> None:
    """Exit code 1 when runs are missing or broken, or the judge's server failed: such runs say nothing about the agent, and the
    same command tries again."""
    from scope_ptz.cli.bench_rescore import judge_failed
    from scope_ptz.cli.bench_troubles import troubles
    from scope_ptz.cli.endings import complain

    evaluation, judged = ended.evaluation, ended.judged
    broken = sum(trial.headline == "infrastructure" for trial in evaluation.trials)
    missing = max(evaluation.wanted - len(evaluation.trials), 0)
    for line in troubles(evaluation.trials, evaluation.card):
        complain(line)
    if broken or missing:
        was = "1 run was" if broken == 1 else f"{broken} runs were"
        it = "it" if broken + missing == 1 else "them"
        lacks = f" and {missing} {'is' if missing == 1 else 'are'} missing" if missing else ""
        complain(f"{was} broken by infrastructure{lacks}; the same command runs {it} again.")
    if judged is not None and judged.failed:
        complain(
            f"{judge_failed(judged)} No run is lost; the same command asks the judge again, and so does "
            f"`scope bench rescore {evaluation.log} --judge-url ...`."
        )
    if broken or missing or (judged is not None and judged.failed):
        sys.exit(FAILED)


def result(evaluation: Evaluation) -> dict[str, object]:
    """What ``--json`` prints. Runs without a judge's verdict, where only a judge can score, are in no share. ``troubles``: what
    servers did to runs, in sentences."""
    from scope_ptz.bench.judging.judgement_tally import not_judged
    from scope_ptz.cli.bench_live import CATEGORIES, accuracy, macro
    from scope_ptz.cli.bench_troubles import events_of, troubles

    trials = evaluation.trials
    groups = {name: [t for t in trials if t.task.category == name] for name in CATEGORIES}
    return {
        "log": evaluation.log,
        "pair": evaluation.card.pair,
        "finished": evaluation.finished,
        "runs": len(trials),
        "wanted": evaluation.wanted,
        "macro": macro(trials),
        "micro": accuracy(trials),
        "by_category": {name: accuracy(group) for name, group in groups.items() if group},
        "headlines": {
            name: sum(t.headline == name for t in trials) for name in ("correct", "incorrect", "unscored", "infrastructure")
        },
        "not_judged": sum(not_judged(t) for t in trials),
        "server_events": dict(events_of(trials)),
        "troubles": troubles(trials, evaluation.card),
    }


def price_of(text: str | None) -> Price | None:
    """``IN,OUT`` as a price. Raises ``InputError``."""
    if text is None:
        return None
    from scope_ptz.bench.engine.estimate import Price

    try:
        given = [float(part) for part in text.split(",")]
    except ValueError:
        given = []
    if len(given) != 2 or min(given) < 0:
        raise InputError(f"--price wants two amounts, in and out, in US dollars per million tokens (0.15,0.60), got '{text}'.")
    return Price(*given)

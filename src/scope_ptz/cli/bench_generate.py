"""``scope bench generate``: a language model drafts tasks; those that programs can prove are kept for a person to look through."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench_browse import CATEGORIES
from scope_ptz.cli.endings import FAILED, complain, ending, put
from scope_ptz.errors import ConfigError, InputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Category, Task
    from scope_ptz.endpoints.endpoint import Endpoint
    from scope_ptz.simulator.pack import Scene
    from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
    from scope_ptz.taskgen.generating.drafting_loop import GenerationRequest, Prove


def generate(
    scene: Annotated[str, typer.Option("--scene", help="The scene that the tasks are set in, or a variation of it.")],
    url: Annotated[str, typer.Option("--url", help="Address of an OpenAI-compatible server, with its /v1.")],
    out: Annotated[Path, typer.Option("--out", help="Folder of drafts, kept tasks and review list; name it again to go on.")],
    model: Annotated[str, typer.Option(help="What the server calls the model (default: the only one it lists).")] = "",
    key_file: Annotated[Path | None, typer.Option("--key-file", help="File with the server's key.")] = None,
    number: Annotated[int, typer.Option("--n", min=1, help="How many tasks, shared out like the published ones.")] = 20,
    want: Annotated[list[str] | None, typer.Option("--want", metavar="CATEGORY=N", help="Or so many of each category.")] = None,
    known: Annotated[str, typer.Option(help="Split or task file: examples, not to be repeated.")] = "",
    runs: Annotated[Path | None, typer.Option(help="Folder of recorded runs of operators.")] = None,
    feedback: Annotated[
        Path | None, typer.Option(help='JSONL: {"run": folder name, "rating": "good" or "bad", "note": ...}.')
    ] = None,
    requests: Annotated[int, typer.Option(min=1, help="Requests to the model at most, earlier ones in the folder included.")] = 20,
    temperature: Annotated[float, typer.Option(min=0, max=2)] = 0.8,
    seed: Annotated[int, typer.Option(help="Of the views and examples shown, and of the model where it takes one.")] = 1,
    timeout: Annotated[float, typer.Option(min=0.1, help="Seconds for a request, retries included.")] = 300.0,
) -> None:
    """Have a model draft tasks. Expected values are worked out from the ground truth; what cannot be proved is dropped."""
    with ending():
        import anyio

        from scope_ptz.bench.tasks.splits import load_split
        from scope_ptz.factory.scenes import open_scene
        from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
        from scope_ptz.taskgen.generating.drafting_loop import GenerationRequest
        from scope_ptz.taskgen.generating.operator_runs import read_runs

        order = GenerationRequest(
            scene=open_scene(scene),
            requested=_wanted(want or [], number),
            known=load_split(known) if known else (),
            runs=read_runs(runs, feedback),
            seed=seed,
            most_requests=requests,
        )
        ledger = DraftLedger(out)
        endpoint = _endpoint(url, key_file, timeout)
        try:
            anyio.run(_run, order, ledger, endpoint, model, temperature)
        finally:
            tasks, review = ledger.finish()
        missing = ledger.missing(order.requested)
        put(f"{len(ledger.kept)} tasks kept of {len(ledger.entries)} drafts: {tasks}; to look through: {review}")
        if missing:
            complain(
                "still missing: " + ", ".join(f"{n} of {name}" for name, n in missing.items()) + ". Go on with more --requests."
            )
            sys.exit(FAILED)


async def _run(order: GenerationRequest, ledger: DraftLedger, endpoint: Endpoint, model: str, temperature: float) -> None:
    from scope_ptz.bench.judging.server import JudgeModelOptions, JudgeServer
    from scope_ptz.taskgen.generating.drafting_loop import generate as drafts

    options = JudgeModelOptions(temperature=temperature, seed=order.seed)
    port = JudgeServer(await _named(endpoint, model), options)
    try:
        await drafts(order, port, prover(order.scene), ledger, complain)
    finally:
        await port.close()


def prover(scene: Scene) -> Prove:
    """Proof of single tasks by the same attempts as ``scope bench validate`` makes."""
    from scope_ptz.factory.validation_perception import KnownViews, equip_with_truth
    from scope_ptz.taskgen.validation.validate import validate

    views = KnownViews()
    equip = equip_with_truth({scene.name: scene}, views)

    async def prove(task: Task) -> str | None:
        report = await validate([task], {task.world: scene}, equip, read_truth=views.look)
        wrong = [*report.faults, *report.adversarial_passes, *report.disagreements]
        return f"{wrong[0].attempt}: {wrong[0].reason}" if wrong else None

    return prove


def _wanted(want: list[str], number: int) -> dict[Category, int]:
    """How many of each category: as given, or the published shares of a number."""
    from scope_ptz.taskgen.authoring.assembly import QUOTAS

    if not want:
        shares = sorted(QUOTAS, key=lambda name: -(number * QUOTAS[name] / sum(QUOTAS.values()) % 1))
        wanted = {name: number * QUOTAS[name] // sum(QUOTAS.values()) for name in QUOTAS}
        for name in shares[: number - sum(wanted.values())]:
            wanted[name] += 1
        return {name: n for name, n in wanted.items() if n}
    found: dict[Category, int] = {}
    for given in want:
        written, _, count = given.partition("=")
        category = next((name for name in QUOTAS if name == written), None)
        if category is None or not count.isdecimal() or not int(count):
            raise InputError(f"--want {given}: a category and a number, such as counting=5. Categories: {', '.join(CATEGORIES)}.")
        found[category] = int(count)
    return found


def _endpoint(url: str, key_file: Path | None, timeout_s: float) -> Endpoint:
    from pydantic import ValidationError

    from scope_ptz.endpoints.endpoint import Endpoint, Timeouts, key_from_file

    key = key_from_file(key_file) if key_file else None
    try:
        return Endpoint(url=url, key=key, timeouts=Timeouts.within(timeout_s))
    except ValidationError as error:
        raise ConfigError(f"--url {url}: {error.errors(include_url=False, include_input=False)[0]['msg']}.") from None


async def _named(endpoint: Endpoint, model: str) -> Endpoint:
    """The endpoint with the name of its model."""
    from scope_ptz.endpoints.catalogue import find_api
    from scope_ptz.endpoints.failures import ServerFailure

    if model:
        return endpoint.model_copy(update={"model": model})
    try:
        endpoint, served = await find_api(endpoint)
    except ServerFailure as failure:
        raise ConfigError(
            f"The server at {endpoint.url} does not say which model it serves ({failure}). Name it with --model."
        ) from None
    if len(served) != 1:
        raise InputError(f"The server at {endpoint.url} serves {', '.join(served[:20]) or 'no model'}. Name one with --model.")
    return endpoint.model_copy(update={"model": served[0]})

"""Commands that add tasks: ``generate`` (with a language model), ``drafts`` (from operators' runs), ``import`` (from CSV files)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.exit import FAILED, print_error, put, put_json
from scope_ptz.cli.options import JsonOption
from scope_ptz.errors import ConfigError, InputError, OutputError

if TYPE_CHECKING:
    from scope_ptz.bench.tasks.task import Category
    from scope_ptz.endpoints.endpoint import Endpoint
    from scope_ptz.simulator.pack import Scene
    from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
    from scope_ptz.taskgen.generating.drafting_loop import GenerationRequest
    from scope_ptz.taskgen.generating.run_draft_file import RunDraft
    from scope_ptz.taskgen.importing.scene_names import SceneNames

MAX_MODELS_LISTED = 20


def generate(
    scene: Annotated[str, typer.Option("--scene", help="Scene, or variation of a scene, that the tasks are about.")],
    url: Annotated[str, typer.Option("--url", help="Address of an OpenAI-compatible server, ending in /v1.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for drafts, accepted tasks and the review list.")],
    model: Annotated[str, typer.Option(help="Name of the model on its server (default: the only one it lists).")] = "",
    key_file: Annotated[Path | None, typer.Option("--key-file", help="File with the server's key.")] = None,
    number: Annotated[
        int, typer.Option("--n", min=1, help="Number of tasks, distributed over the categories as in the published splits.")
    ] = 20,
    requested: Annotated[
        list[str] | None, typer.Option("--want", metavar="CATEGORY=N", help="Number of tasks of a category, instead of --n.")
    ] = None,
    known: Annotated[str, typer.Option(help="Split or task file with tasks that serve as examples and must not be repeated.")] = "",
    runs: Annotated[Path | None, typer.Option(help="Folder with recorded runs of operators, as examples.")] = None,
    feedback: Annotated[
        Path | None, typer.Option(help='Ratings of runs, JSONL: {"run": folder name, "rating": "good" or "bad", "note": ...}.')
    ] = None,
    requests: Annotated[
        int, typer.Option(min=1, help="Maximum number of requests to the model, including earlier ones in the folder.")
    ] = 20,
    temperature: Annotated[float, typer.Option(min=0, max=2, help="Sampling temperature of the model.")] = 0.8,
    seed: Annotated[int, typer.Option(help="Seed for the choice of views and examples, and for the model if it accepts one.")] = 1,
    timeout: Annotated[float, typer.Option(min=0.1, help="Timeout in seconds for a request, including retries.")] = 300.0,
) -> int:
    """Draft tasks with a language model. Expected answers come from the ground truth; tasks that fail validation are dropped.

    Running the same command again continues in the same folder.
    """
    import anyio

    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.factory.worlds import open_scenes
    from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
    from scope_ptz.taskgen.generating.drafting_loop import GenerationRequest
    from scope_ptz.taskgen.generating.operator_runs import read_runs

    request = GenerationRequest(
        scene=open_scenes([scene])[scene],
        requested=_requested_counts(requested or [], number),
        known=load_split(known) if known else (),
        runs=read_runs(runs, feedback),
        seed=seed,
        max_requests=requests,
    )
    ledger = DraftLedger(out)
    endpoint = _endpoint(url, key_file, timeout)
    try:
        anyio.run(_draft_tasks, request, ledger, endpoint, model, temperature)
    finally:
        tasks, review = ledger.finish()
    missing = ledger.missing(request.requested)
    put(f"Accepted {len(ledger.kept)} of {len(ledger.entries)} drafts: {tasks}; to review: {review}")
    if missing:
        names = ", ".join(f"{n} of {name}" for name, n in missing.items())
        print_error(f"still missing: {names}. Run the same command again with a higher --requests.")
        return FAILED
    return 0


async def _draft_tasks(request: GenerationRequest, ledger: DraftLedger, endpoint: Endpoint, model: str, temperature: float) -> None:
    from scope_ptz.bench.judging.server import JudgeModelOptions, JudgeServer
    from scope_ptz.factory.task_validation import task_validator
    from scope_ptz.taskgen.generating.drafting_loop import generate as generate_tasks

    options = JudgeModelOptions(temperature=temperature, seed=request.seed)
    server = JudgeServer(await _select_model(endpoint, model), options)
    try:
        await generate_tasks(request, server, task_validator(request.scene), ledger, print_error)
    finally:
        await server.close()


def _requested_counts(requested: list[str], number: int) -> dict[Category, int]:
    """Return the number of tasks per category: as given in ``requested``, or ``number`` tasks in the published proportions."""
    from scope_ptz.taskgen.authoring.assembly import QUOTAS

    if not requested:
        by_remainder = sorted(QUOTAS, key=lambda name: -(number * QUOTAS[name] / sum(QUOTAS.values()) % 1))
        counts = {name: number * QUOTAS[name] // sum(QUOTAS.values()) for name in QUOTAS}
        for name in by_remainder[: number - sum(counts.values())]:
            counts[name] += 1
        return {name: n for name, n in counts.items() if n}
    counts_by_category: dict[Category, int] = {}
    for entry in requested:
        category_name, _, count = entry.partition("=")
        category = next((name for name in QUOTAS if name == category_name), None)
        if category is None or not count.isdecimal() or not int(count):
            raise InputError(
                f"--want must have the form CATEGORY=N, for example counting=5; got '{entry}'. "
                f"The categories are: {', '.join(QUOTAS)}."
            )
        counts_by_category[category] = int(count)
    return counts_by_category


def _endpoint(url: str, key_file: Path | None, timeout_s: float) -> Endpoint:
    from pydantic import ValidationError

    from scope_ptz.endpoints.endpoint import Endpoint, Timeouts, key_from_file

    key = key_from_file(key_file) if key_file else None
    try:
        return Endpoint(url=url, key=key, timeouts=Timeouts.within(timeout_s))
    except ValidationError as error:
        raise ConfigError(f"--url {url}: {error.errors(include_url=False, include_input=False)[0]['msg']}.") from None


async def _select_model(endpoint: Endpoint, model: str) -> Endpoint:
    """Return the endpoint with the given model or, if none is given, the only model that the server lists."""
    from scope_ptz.endpoints.catalogue import find_api
    from scope_ptz.endpoints.failures import ServerFailure

    if model:
        return endpoint.model_copy(update={"model": model})
    try:
        endpoint, served = await find_api(endpoint)
    except ServerFailure as failure:
        raise ConfigError(
            f"The server at {endpoint.url} does not report which model it serves ({failure}). Name it with --model."
        ) from None
    if len(served) != 1:
        raise InputError(
            f"The server at {endpoint.url} serves {', '.join(served[:MAX_MODELS_LISTED]) or 'no model'}. Name one with --model."
        )
    return endpoint.model_copy(update={"model": served[0]})


def drafts(
    file: Annotated[Path, typer.Argument(help="File that 'scope runs export --format drafts' wrote.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for the drafts, the accepted tasks and the review list.")],
    known: Annotated[str, typer.Option(help="Split or task file whose tasks must not be repeated (default: none).")] = "",
    as_json: JsonOption = False,
) -> int:
    """Convert drafts from operators' runs to tasks. Expected answers come from the ground truth. Invalid drafts are dropped.

    The output lists every draft, with the reason if it was dropped. The exit code is 1 if no task was accepted.

    Running the same command again skips drafts that the folder already contains.
    """
    import anyio

    from scope_ptz.bench.tasks.splits import load_split
    from scope_ptz.factory.task_validation import task_validator
    from scope_ptz.factory.worlds import open_scenes
    from scope_ptz.taskgen.facts.near_duplicates import KnownTasks
    from scope_ptz.taskgen.generating.draft_ledger import DraftLedger
    from scope_ptz.taskgen.generating.run_draft_file import read_run_drafts, validate_run_drafts

    run_drafts, ledger = read_run_drafts(file), DraftLedger(out)
    earlier_count = len(ledger.entries)
    known_tasks = KnownTasks([*(load_split(known) if known else ()), *ledger.kept])

    def open_scene(name: str) -> Scene | None:
        try:
            return open_scenes([name])[name]
        except InputError:
            return None

    async def work() -> None:
        await validate_run_drafts(run_drafts, open_scene, task_validator, known_tasks, ledger)

    try:
        anyio.run(work)
    finally:
        tasks, review = ledger.finish()
    if as_json:
        put_json(
            {
                "drafts": [entry.model_dump(mode="json", include={"fate", "reason", "draft"}) for entry in ledger.entries],
                "new": len(ledger.entries) - earlier_count,
                "accepted": len(ledger.kept),
                "tasks": str(tasks),
                "review": str(review),
            }
        )
    else:
        _print_entries(run_drafts, ledger, earlier_count)
        put(f"Accepted {len(ledger.kept)} of {len(ledger.entries)} drafts: {tasks}; to review: {review}")
    return 0 if ledger.kept else FAILED


def _print_entries(run_drafts: list[RunDraft], ledger: DraftLedger, first: int) -> None:
    for entry in ledger.entries[first:]:
        text = entry.draft.get("instruction", "") if isinstance(entry.draft, dict) else str(entry.draft or "")
        put(f"{entry.fate:<15} {text[:90]}")
        if entry.reason:
            put(f"{'':<15} {entry.reason}")
    if not run_drafts:
        put("The file contains no drafts. Rate runs as good, then export them again.")


def import_tasks(
    file: Annotated[Path, typer.Argument(help="CSV file in the paper's published format.")],
    scenes: Annotated[
        Path | None,
        typer.Option("--scenes", help="Folder with the scenes that the file refers to (default: the installed scenes)."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", help="File for the tasks (JSONL; default: NAME.imported.jsonl for NAME.csv, in the current folder)."),
    ] = None,
    mapping: Annotated[
        Path | None, typer.Option("--map", help="YAML or JSON file that maps the file's locations and presets to scenes.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Import tasks from a file in the paper's format: map tools, arguments, categories and scenes, and report doubtful rows.

    The exit code is 1 if no row can be run.
    """
    from scope_ptz.bench.tasks.imported import dump_imported
    from scope_ptz.taskgen.importing.import_report import import_file, report_lines

    imported = import_file(file, known_scenes(scenes, mapping))
    target = out or Path(f"{file.stem}.imported.jsonl")
    report_file = target.with_name(target.name.removesuffix(".jsonl") + ".report.json")
    dump_imported(imported.tasks, target)
    report_data = imported.as_dict()
    try:
        report_file.write_text(json.dumps(report_data, indent=1, ensure_ascii=False) + "\n", "utf-8")
    except OSError as error:
        raise OutputError(f"The report {report_file} cannot be written: {error.strerror}.") from error
    if as_json:
        put_json(report_data, indent=1)
    else:
        for line in report_lines(imported):
            put(line)
        put("")
        put(f"{len(imported.tasks)} tasks in {target}, findings for every row in {report_file}")
        if any(report_data["map_to_fill"].values()):
            put("Map unknown names of scenes and presets with --map; 'map_to_fill' in the report lists them.")
    if not imported.tasks and not report_data["rows"]:
        print_error(f"{file} contains a header but no rows, so there is nothing to import.")
    elif not imported.tasks:
        known = ", ".join(sorted(known_scenes(scenes, mapping).scenes)) or "none"
        print_error(
            f"no row can be run. Known scenes: {known}. Give the scenes of the file with --scenes, or map their names with --map."
        )
    return 0 if imported.tasks else FAILED


def known_scenes(folder: Path | None, mapping: Path | None) -> SceneNames:
    """Return the scenes in a folder and the installed scenes, with a mapping of their names.

    Raises:
        InputError: The folder does not exist, or the mapping cannot be read.
    """
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.pack import list_scenes, load_scene
    from scope_ptz.taskgen.importing.scene_names import SceneNameMap, SceneNames, ScenePresets, read_scene_names

    if folder is not None and not folder.is_dir():
        raise InputError(f"The scene folder {folder} does not exist.")
    folders = (*([folder] if folder else []), *scene_search(load_settings()))
    known = {}
    for name in list_scenes(folders):
        file = load_scene(name, folders).file
        known[name] = ScenePresets({preset.name: preset.viewpoint for preset in file.presets}, file.home_preset, file.start_s)
    return SceneNames(known, read_scene_names(mapping) if mapping else SceneNameMap())

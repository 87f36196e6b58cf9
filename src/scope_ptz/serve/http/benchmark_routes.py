"""Routes that start, follow, cancel and resume evaluations, show individual runs, and serve the report."""

from __future__ import annotations

from collections import Counter
from functools import partial
from typing import Annotated, Literal

from fastapi import APIRouter, Path, Query, Response
from fastapi.responses import FileResponse

from scope_ptz.agent.trace import picture_names
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.errors import ConfigError, InputError, TraceError, UnknownNameError
from scope_ptz.serve.http.benchmark_models import (
    BenchmarkModel,
    CheckModel,
    EvaluationModel,
    EvaluationStart,
    SplitModel,
    TrialDetails,
    TrialList,
    TrialModel,
    TrialStep,
)
from scope_ptz.serve.http.dependencies import Operator, RunOperator, SiteDep, StoppingOperator, Viewer
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.site.benchmark.evaluations import EvaluationRequest
from scope_ptz.serve.site.benchmark.splits import installed_splits, missing_packages
from scope_ptz.serve.site.benchmark.trajectories import steps_of
from scope_ptz.serve.site.site import Site

REPORT_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)
"""The content security policy for reports. Reports have no scripts and load only their own pictures."""

_MEDIA_TYPES = {"tasks": "text/html", "frames": "image/jpeg", "tables": "text/csv"}

router = APIRouter(prefix="/benchmark", tags=["benchmark"])
EvaluationId = Annotated[str, Path(min_length=1, max_length=120)]
Sample = Annotated[str, Path(min_length=1, max_length=200)]
_ERRORS = responses(404, 409)


@router.get("", responses=responses())
async def benchmark(site: SiteDep, client: Viewer) -> BenchmarkModel:  # noqa: ARG001 - checks the token
    """Return the pairs and splits that can be evaluated, and the id of the evaluation in progress."""
    splits = await site.library.in_thread(installed_splits)
    return BenchmarkModel(
        pairs=list(site.pairs.names),
        splits=[SplitModel(name=split.name, tasks=split.tasks, by_category=split.by_category) for split in splits],
        missing=missing_packages(),
        running=await site.library.in_thread(site.evaluations.running),
    )


@router.get("/evaluations", responses=responses())
async def list_evaluations(site: SiteDep, client: Viewer) -> list[EvaluationModel]:  # noqa: ARG001 - checks the token
    """List the evaluations that were started on the server, newest first."""
    return [EvaluationModel.of(status) for status in await site.library.in_thread(site.evaluations.all)]


@router.post("/evaluations", status_code=202, responses=responses(404, 409, 507))
async def start_evaluation(site: SiteDep, client: RunOperator, body: EvaluationStart) -> EvaluationModel:
    """Start an evaluation and reply immediately. It runs in a separate process. Only one evaluation runs at a time."""
    if missing := missing_packages():
        raise ConfigError(missing)
    split = next((installed for installed in await site.library.in_thread(installed_splits) if installed.name == body.split), None)
    if split is None:
        raise InputError(f"The split '{body.split}' is not installed. `GET /benchmark` lists the installed splits.")
    categories = tuple(dict.fromkeys(body.categories))
    if missing_categories := [name for name in categories if name not in split.by_category]:
        raise InputError(f"The split '{body.split}' has no tasks in the category {missing_categories[0].replace('_', ' ')}.")
    request = EvaluationRequest(site.pairs.check(body.pair), body.split, body.limit, categories)
    return await _status(site, await site.library.in_thread(partial(site.evaluations.start, request, client.name)))


@router.get("/evaluations/{evaluation}", responses=_ERRORS)
async def evaluation_state(site: SiteDep, client: Viewer, evaluation: EvaluationId) -> EvaluationModel:  # noqa: ARG001 - checks the token
    """Return an evaluation's state, its scores so far, and the estimated remaining time."""
    return await _status(site, evaluation)


@router.post("/evaluations/{evaluation}/cancel", status_code=202, responses=_ERRORS)
async def cancel_evaluation(site: SiteDep, client: StoppingOperator, evaluation: EvaluationId) -> EvaluationModel:  # noqa: ARG001 - checks the token
    """Cancel an evaluation. Finished runs are kept, and the evaluation can be resumed."""
    await site.library.in_thread(partial(site.evaluations.cancel, evaluation))
    return await _status(site, evaluation)


@router.post("/evaluations/{evaluation}/resume", status_code=202, responses=responses(404, 409, 507))
async def resume_evaluation(site: SiteDep, client: RunOperator, evaluation: EvaluationId) -> EvaluationModel:  # noqa: ARG001 - checks the token
    """Resume an evaluation that has ended: run its missing and broken runs."""
    await site.library.in_thread(partial(site.evaluations.resume, evaluation))
    return await _status(site, evaluation)


@router.delete("/evaluations/{evaluation}", status_code=204, responses=_ERRORS)
async def remove_evaluation(site: SiteDep, client: Operator, evaluation: EvaluationId) -> Response:  # noqa: ARG001 - checks the token
    """Remove an evaluation that has ended, with its logs and its report."""
    await site.library.in_thread(partial(site.evaluations.remove, evaluation))
    return Response(status_code=204)


@router.get("/evaluations/{evaluation}/trials", responses=_ERRORS)
async def list_trials(
    site: SiteDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    evaluation: EvaluationId,
    verdict: Annotated[
        Literal["failed", "correct", "incorrect", "unscored", "infrastructure"] | None,
        Query(description="`failed` matches every verdict except `correct`"),
    ] = None,
    error_mode: Annotated[str | None, Query(max_length=60)] = None,
    category: Annotated[str | None, Query(max_length=60)] = None,
    limit: Annotated[int, Query(ge=1, le=500)] = 100,
    offset: Annotated[int, Query(ge=0, le=1_000_000)] = 0,
) -> TrialList:
    """List an evaluation's finished runs, with their expected and actual answers."""
    trials = await _trials(site, evaluation)
    modes = Counter(trial.error_mode.value for trial in trials if trial.error_mode is not None)
    matches = [
        trial
        for trial in trials
        if (verdict is None or (trial.headline != "correct" if verdict == "failed" else trial.headline == verdict))
        and (error_mode is None or (trial.error_mode is not None and trial.error_mode.value == error_mode))
        and (category is None or trial.task.category == category)
    ]
    shown = [TrialModel.of(trial) for trial in matches[offset : offset + limit]]
    return TrialList(trials=shown, count=len(matches), error_modes=dict(modes.most_common()))


@router.get("/evaluations/{evaluation}/trials/{sample}", responses=_ERRORS)
async def trial_details(site: SiteDep, client: Viewer, evaluation: EvaluationId, sample: Sample) -> TrialDetails:  # noqa: ARG001 - checks the token
    """Return a run with its checks, its steps and the names of its pictures."""
    trial = await _trial(site, evaluation, sample)
    steps, start_picture, trace_error = [], None, ""
    try:
        folder = site.evaluations.folder(evaluation)
        trace = await site.library.in_thread(partial(site.trajectories.trace, folder, trial))
        steps = [TrialStep.model_validate(step) for step in steps_of(trace)]
        start_picture = next((name for name, position in picture_names(trace).items() if position is None), None)
    except TraceError as error:
        trace_error = str(error)
    return TrialDetails(
        trial=TrialModel.of(trial),
        demands=list(trial.task.demands),
        checks=[CheckModel(name=check.name, passed=check.passed, reason=check.reason) for check in trial.checks],
        start_picture=start_picture,
        steps=steps,
        missing=trace_error,
    )


@router.get(
    "/evaluations/{evaluation}/trials/{sample}/pictures/{part}/{name}",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}, "description": "The picture"}, **_ERRORS},
)
async def trial_picture(
    site: SiteDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    evaluation: EvaluationId,
    sample: Sample,
    part: Literal["frames", "pictures"],
    name: Annotated[str, Path(min_length=1, max_length=60)],
    marks: Annotated[bool, Query(description="Draw the detections on the picture")] = False,
) -> Response:
    """Return a picture from a run, optionally with numbered boxes around the detections."""
    trial = await _trial(site, evaluation, sample)
    folder = site.evaluations.folder(evaluation)
    read_picture = partial(site.trajectories.picture, folder, trial, f"{part}/{name}", marks=marks)
    return Response(
        await site.library.in_thread(read_picture), media_type="image/jpeg", headers={"Cache-Control": "private, max-age=3600"}
    )


@router.post("/evaluations/{evaluation}/report", status_code=202, responses=responses(404, 409, 507))
async def make_report(site: SiteDep, client: RunOperator, evaluation: EvaluationId) -> EvaluationModel:  # noqa: ARG001 - checks the token
    """Start writing an evaluation's report. When the report is complete, the evaluation's field `report` is `ready`."""
    if missing := missing_packages():
        raise ConfigError(missing)
    await site.library.in_thread(partial(site.evaluations.make_report, evaluation))
    return await _status(site, evaluation)


@router.get(
    "/evaluations/{evaluation}/report/index.html",
    response_class=FileResponse,
    responses={200: {"content": {"text/html": {}}, "description": "The report"}, **_ERRORS},
)
async def report_page(site: SiteDep, client: Viewer, evaluation: EvaluationId) -> FileResponse:  # noqa: ARG001 - checks the token
    """Return the report's first page."""
    folder = await site.library.in_thread(partial(site.evaluations.folder, evaluation))
    page = await site.library.in_thread(folder.report_page)
    if page is None:
        raise TraceError("This evaluation has no report yet, or runs have ended since it was written. Create it first.")
    return FileResponse(page, media_type="text/html", headers={"Content-Security-Policy": REPORT_POLICY})


@router.get(
    "/evaluations/{evaluation}/report/{part}/{name}",
    response_class=FileResponse,
    responses={
        200: {"content": {"text/html": {}, "image/jpeg": {}, "text/csv": {}}, "description": "A page, picture or table"},
        **_ERRORS,
    },
)
async def report_file(
    site: SiteDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    evaluation: EvaluationId,
    part: Literal["tasks", "frames", "tables"],
    name: Annotated[str, Path(min_length=1, max_length=120)],
) -> FileResponse:
    """Return a page, picture or table from the report."""
    folder = await site.library.in_thread(partial(site.evaluations.folder, evaluation))
    path = await site.library.in_thread(partial(folder.report_file, part, name))
    if path is None:
        raise UnknownNameError("report file", name[:120], ())
    return FileResponse(path, media_type=_MEDIA_TYPES[part], headers={"Content-Security-Policy": REPORT_POLICY})


async def _status(site: Site, evaluation: str) -> EvaluationModel:
    return EvaluationModel.of(await site.library.in_thread(partial(site.evaluations.status, evaluation)))


async def _trials(site: Site, evaluation: str) -> list[Trial]:
    folder = await site.library.in_thread(partial(site.evaluations.folder, evaluation))
    return await site.library.in_thread(folder.trials)


async def _trial(site: Site, evaluation: str, sample: str) -> Trial:
    trial = next((candidate for candidate in await _trials(site, evaluation) if candidate.sample == sample), None)
    if trial is None:
        raise UnknownNameError("run in this evaluation", sample[:120], ())
    return trial

"""Results to compare with the stored data: each function returns a result of the current code as JSON-like data."""

from __future__ import annotations

import gzip
import hashlib
import json
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

from tests.frozen import adapter
from tests.frozen.server import Reply, ScriptedServer, calls_message, text_message

DATA = Path(__file__).parent / "v0_1_0"
RUNS, LOGS = DATA / "traces", DATA / "logs"
SUBMISSION = DATA / "submission.jsonl"
SUBMITTED_LOG = LOGS / "reaction.eval"
RUN_NAMES = sorted(path.name for path in RUNS.iterdir())
LOG_NAMES = sorted(path.stem for path in LOGS.glob("*.eval"))
REPORTED_LOGS = ("truth", "noisy", "repeats", "judged", "served", "agent")
RANKED_LOGS = {
    "judged": ("qwen3-4b", "moondream2"),
    "truth": ("qwen3-30b-a3b", "moondream2"),
    "noisy": ("qwen3-4b", "qwen2.5-vl-7b"),
}
"""Logs that are also reported as copies under the names of these models (planner, perception), so that they are ranked."""
JUDGED_LOG = "truth"
"""The log whose runs a scripted judge evaluates. It has runs of all eight categories."""


def stored_result(name: str) -> Any:
    """Return an expected result from the stored data."""
    return json.loads((DATA / name).read_text("utf-8"))


def call(tool: str, /, **arguments: Any) -> dict[str, Any]:
    """Return a tool call as the model would send it."""
    return {"name": tool, "arguments": arguments}


EVERY_TOOL = [
    [call("get_presets")],
    [call("go_to_preset", name="gate")],
    [call("go_to_preset", name="moon")],
    [call("adjust_ptz", pan_deg=12.5, tilt_deg=3.0)],
    [call("adjust_ptz", tilt_deg=-200.0)],
    [call("adjust_ptz", tilt_deg=400.0, zoom_factor=50.0)],
    [call("adjust_ptz", zoom_limit="out")],
    [call("adjust_ptz", zoom_percent=50.0)],
    [call("adjust_ptz", zoom_factor=2.0, zoom_limit="in")],
    [call("adjust_ptz", sideways=1)],
    [call("adjust_ptz", pan_deg="far")],
    [{"name": "adjust_ptz", "arguments": '{"pan_deg": 12'}],
    [{"name": "adjust_ptz", "arguments": "[1]"}],
    [call("dance")],
    [call("go_home")],
    [call("take_image")],
    [call("count_objects", description="cones", view="current")],
    [call("count_objects", description="giraffes")],
    [call("count_objects", description=" ")],
    [call("query_answer", question="is there a worker?", view="current")],
    [call("query_answer", question="why is the sky blue?")],
    [call("query_answer")],
    [call("zoom_to_object", description="excavator")],
    [call("zoom_to_object", description="giraffe")],
    [call("go_to_preset", name="highway")],
    [call("track_object", description="car", duration_s=1.0)],
    [call("track_object", description="giraffe", duration_s=2.0)],
    [call("track_object", description="car", duration_s=-1.0)],
    [call("adjust_ptz", pan_deg=1.0), call("go_to_preset", name="moon"), call("go_home")],
]
"""Steps that call every tool successfully, and with clamped values, missing objects and wrong arguments."""

SWEEPS = [
    [call("count_objects", description="workers", view="full")],
    [call("query_answer", question="is there a giraffe?", view="full")],
    [call("go_to_preset", name="highway")],
    [call("track_object", description="car", duration_s=6.0)],
]
"""Steps that take longer: perception of the full scene, and tracking."""

FEW_CALLS = [
    [call("get_presets")],
    [call("adjust_ptz", zoom_factor=50.0)],
    [call("dance")],
    [call("count_objects", description="cones")],
]

CONVERSATIONS: dict[str, tuple[dict[str, str], list[list[dict[str, Any]]]]] = {
    "every-tool": ({"stream": "false"}, EVERY_TOOL),
    "sweeps": ({"stream": "false"}, SWEEPS),
    "written": ({"stream": "false", "tools": "text", "prompt": "short-1"}, FEW_CALLS),
    "examples": ({"stream": "false", "prompt": "examples-1", "thinking": "off", "temperature": "0.5", "seed": "3"}, FEW_CALLS),
}


def conversation(name: str, scratch: Path) -> dict[str, Any]:
    """Run a scripted chat model and return its last request, which contains all earlier messages, and the results of its calls."""
    options, steps = CONVERSATIONS[name]
    calls_as_text = options.get("tools") == "text"

    def script(body: dict[str, Any]) -> dict[str, Any]:
        step_index = sum(message["role"] == "assistant" for message in body["messages"])
        first = next(index for index, m in enumerate(body["messages"]) if m["role"] == "user" and "every tool" in str(m["content"]))
        step_index -= sum(message["role"] == "assistant" for message in body["messages"][:first])
        if step_index >= len(steps):
            return text_message("All done.")
        if calls_as_text:
            return text_message("\n".join(f"<tool_call>\n{json.dumps(tool_call)}\n</tool_call>" for tool_call in steps[step_index]))
        return calls_message(steps[step_index])

    with ScriptedServer(script) as server:
        trace = adapter.ask("use every tool", scratch, planner={"url": server.url, **options})
    calls = [record["outcome"] | {"fault": record["fault"]} for record in trace if record["event"] == "call"]
    return {
        "planner_details": {name: value for name, value in trace[0]["planner_details"].items() if name != "url"},
        "requests": len(server.requests),
        "last_request": server.requests[-1],
        "calls": calls,
        "outcome": trace[-1]["outcome"],
    }


VISION_INSTRUCTIONS = {
    "detect": "count the cones",
    "query": "what colour is the excavator?",
    "point": "zoom in on the excavator",
    "sweep": "is there a giraffe anywhere in the whole scene?",
}


def vision_requests(name: str, scratch: Path) -> list[Any]:
    """Return the requests to a vision model for an instruction, without images and duplicates."""
    with ScriptedServer(lambda _: text_message("[]")) as server:
        adapter.ask(VISION_INSTRUCTIONS[name], scratch, perception=server.url)
    found = {json.dumps(_without_pictures(request), sort_keys=True) for request in server.requests}
    return [json.loads(request) for request in sorted(found)]


def _without_pictures(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_pictures(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_without_pictures(part) for part in value]
    return "data:..." if isinstance(value, str) and value.startswith("data:image/") else value


def verdict(body: dict[str, Any]) -> dict[str, Any] | Reply:
    """Return the reply of a scripted judge. It depends on a digest of the request; for some requests it has no verdict."""
    request = json.dumps(body["messages"][1], sort_keys=True)
    remainder = int(hashlib.sha256(request.encode()).hexdigest(), 16) % 6
    if remainder == 0:
        return text_message("I think it went well.")
    good = {"reason": "All as asked.", "verdict": "correct", "error_mode": None}
    bad = {"reason": "It counted wrongly.", "verdict": "incorrect", "error_mode": "vlm_counting"}
    return text_message(json.dumps(bad if remainder < 3 else good))


def judge_results(scratch: Path) -> dict[str, Any]:
    """Rescore a log with a scripted judge, and return the requests, the judgements and the scores."""
    with adapter.copied_log(LOGS / f"{JUDGED_LOG}.eval", scratch) as log, ScriptedServer(verdict, "the-judge") as server:
        result = adapter.rescore_judge(log, server.url)
        assert result.code == 0, result.err
        systems = dict[str, str]()
        requests = []
        for request in server.requests:
            system, *rest = request["messages"]
            key = hashlib.sha256(system["content"].encode()).hexdigest()[:12]
            systems[key] = system["content"]
            requests.append({**request, "messages": [f"system {key}", *rest]})
        requests.sort(key=lambda request: json.dumps(request, sort_keys=True))
        judgements = {
            trial["sample"]: [{k: v for k, v in judgement.items() if k != "latency_s"} for judgement in trial["judgements"]]
            for trial in adapter.read_log(log)["trials"]
        }
        return {"systems": systems, "requests": requests, "scores": adapter.scores_of(log), "judgements": judgements}


def replays(names: Iterable[str]) -> dict[str, Any]:
    """Replay run folders and return the exit code and result of each."""
    return {name: dict(zip(("code", "found"), adapter.replay(RUNS / name), strict=True)) for name in names}


def log_content(name: str) -> dict[str, Any]:
    """Return the content of a log and its scores."""
    return {"evaluation": adapter.read_log(LOGS / f"{name}.eval"), "scores": adapter.scores_of(LOGS / f"{name}.eval")}


def rescored_log(name: str, scratch: Path) -> dict[str, Any]:
    """Rescore the checks of a copy of a log, and return its content and its scores, which include the new one."""
    with adapter.copied_log(LOGS / f"{name}.eval", scratch) as log:
        result = adapter.rescore_checks(log)
        assert result.code == 0, result.err
        return {"evaluation": adapter.read_log(log), "scores": adapter.scores_of(log)}


def tables(scratch: Path) -> dict[str, str]:
    """Return the tables of a report of stored logs and of the copies in ``RANKED_LOGS``."""
    logs = [LOGS / f"{name}.eval" for name in REPORTED_LOGS]
    for name, pair in RANKED_LOGS.items():
        logs.append(as_models(LOGS / f"{name}.eval", scratch / f"{name}.eval", *pair))
    return adapter.report_tables(logs, scratch / "report")


def as_models(log: Path, copy: Path, planner: str, perception: str) -> Path:
    """Copy a log and change its card, so that it names these models as planner and perception."""
    header = adapter.header_of(log)
    card = header["eval"]["metadata"]["card"]
    card["run_id"] = f"{planner}-{perception}"
    for role, name in (("planner", planner), ("perception", perception)):
        card[role] |= {"name": name, "registry": name, "provider": "http", "deterministic": False}
    copy.parent.mkdir(parents=True, exist_ok=True)
    with ZipFile(log) as old, ZipFile(copy, "w", ZIP_DEFLATED) as new:
        for info in old.infolist():
            new.writestr(info.filename, json.dumps(header) if info.filename == "header.json" else old.read(info))
    return copy


def submission(scratch: Path) -> list[dict[str, Any]]:
    """Make a submission from a log and return its lines."""
    return adapter.make_submission(SUBMITTED_LOG, scratch)


def submission_checks(scratch: Path) -> dict[str, Any]:
    """Validate the stored submission unchanged, without its last line, and with a changed verdict."""
    lines = SUBMISSION.read_text("utf-8").splitlines()
    shorter, other = scratch / "shorter.jsonl", scratch / "other.jsonl"
    shorter.write_text("\n".join(lines[:-1]) + "\n", "utf-8")
    other.write_text("\n".join([lines[0], lines[1].replace('"correct"', '"perfect"', 1), *lines[2:]]) + "\n", "utf-8")
    files = {"whole": SUBMISSION, "shorter": shorter, "other": other}
    return {name: dict(zip(("code", "found"), adapter.validate_submission(path), strict=True)) for name, path in files.items()}


def plan_inputs() -> list[dict[str, Any]]:
    """Return the name, instruction and presets of every task, with its plan by version 0.1.0."""
    presets = stored_result("presets.json")
    with gzip.open(DATA / "plans.jsonl.gz", "rt", encoding="utf-8") as file:
        rows = [json.loads(line) for line in file]
    return [{**row, "presets": presets[row["world"]]} for row in rows]


def plans(rows: list[dict[str, Any]], scratch: Path) -> list[dict[str, Any]]:
    """Return the current plans for rows of ``plan_inputs``."""
    return adapter.plan(((row["plan"]["instruction"], row["presets"]) for row in rows), scratch)


def names() -> dict[str, list[str]]:
    """Return the names of tasks, solvers, scorers, metrics, models and model roles in the stored logs."""
    found: dict[str, set[str]] = {kind: set() for kind in ("task", "solver", "scorer", "metric", "model", "role")}
    for name in LOG_NAMES:
        header = adapter.header_of(LOGS / f"{name}.eval")
        evaluation = header["eval"]
        found["task"].add(evaluation["task_registry_name"])
        found["solver"] |= {step["solver"] for step in header["plan"]["steps"]}
        for scorer in evaluation["scorers"]:
            found["scorer"].add(scorer["name"])
            found["metric"] |= {metric["name"] for metric in scorer["metrics"]}
        found["model"].add(evaluation["model"])
        for role, model in evaluation["model_roles"].items():
            found["role"].add(role)
            found["model"].add(model["model"])
    return {kind: sorted(values) for kind, values in found.items()}


def outcomes() -> list[str]:
    """Return all outcomes of the stored runs."""
    ends = (
        json.loads((RUNS / name / "trace.jsonl").read_text("utf-8").splitlines()[-1] or "{}")
        for name in RUN_NAMES
        if name != "cut-off"
    )
    return sorted({end["outcome"] for end in ends})


SIMPLE: dict[str, Callable[[], Any]] = {
    "tools.json": adapter.tool_schemas,
    "digests.json": adapter.digests,
    "names.json": names,
    "replays.json": partial(replays, RUN_NAMES),
}
"""Results that need no scratch folder, by name of the stored file."""

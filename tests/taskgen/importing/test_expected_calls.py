"""The expected tools and arguments of a row are mapped to required calls, and runs are checked against these calls."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.bench.scoring.imported_check import check_imported_calls
from scope_ptz.bench.tasks.imported import ImportedTask
from scope_ptz.bench.tasks.task import Argument
from tests.bench.sample_runs import count_step, play
from tests.taskgen.importing.sample_rows import import_rows, kinds

MAPPED: list[tuple[str, Any, str, dict[str, Argument]]] = [
    ("ptz_adjust", {"pan_deg": 20, "tilt_deg": "-5"}, "adjust_ptz",
     {"pan_deg": Argument(equals=20.0, within=0.5), "tilt_deg": Argument(equals=-5.0, within=0.5)}),
    ("ptz_adjust", {"zoom_factor": 2}, "adjust_ptz", {"zoom_factor": Argument(equals=2.0, within=0.06)}),
    ("ptz_adjust", {"zoom_percent": -50}, "adjust_ptz", {"zoom_factor": Argument(equals=0.5, within=0.015)}),
    ("ptz_adjust", {"zoom_full": "in"}, "adjust_ptz", {"zoom_limit": Argument(equals="in")}),
    ("ptz_adjust", {"zoom_full": "-1"}, "adjust_ptz", {"zoom_limit": Argument(equals="out")}),
    ("go_to_preset", {"name": "Preset Highway"}, "go_to_preset", {"name": Argument(equals="highway")}),
    ("home_action", {}, "go_home", {}),
    ("get_presets", {}, "get_presets", {}),
    ("take_image", {}, "take_image", {}),
    ("count_pointing", {"object_of_interest": "the red cars", "view_type": "Full Scene"}, "count_objects",
     {"description": Argument(mentions=("red cars", "cars")), "view": Argument(equals="full")}),
    ("query_answer", {"instruction": "what is there?", "view_type": "current"}, "query_answer",
     {"view": Argument(equals="current")}),
    ("zoom_bounding", {"object_of_interest": "stop sign"}, "zoom_to_object",
     {"description": Argument(mentions=("stop sign", "sign"))}),
    ("track_object", {"object_of_interest": "van", "duration": 0.5, "unit": "minutes"}, "track_object",
     {"description": Argument(mentions=("van",)), "duration_s": Argument(equals=30.0, within=0.5)}),
]  # fmt: skip


@pytest.mark.parametrize(("theirs", "arguments", "ours", "required"), MAPPED)
@pytest.mark.parametrize("form", ["list", "by tool", "inside", "python"])
def test_tools_and_arguments(
    tmp_path: Path, form: str, theirs: str, arguments: dict[str, Any], ours: str, required: dict[str, Argument]
) -> None:
    cells = {
        "list": (json.dumps([theirs]), json.dumps([arguments])),
        "by tool": (json.dumps([theirs]), json.dumps({theirs: arguments})),
        "inside": (json.dumps([{"tool": theirs, "args": arguments}]), ""),
        "python": (repr([theirs]), repr([{"tool": theirs, "args": arguments}])),
    }
    order, args = cells[form]
    result = import_rows(tmp_path, {"expected_tool_order_json": order, "expected_tool_args_json": args})
    ((call,),) = (task.calls for task in result.tasks)
    assert (call.tool, call.arguments) == (ours, required)
    assert not kinds(result) & {"wrong-arguments", "unknown-tool", "unreadable-cell"}


@pytest.mark.parametrize(
    ("tool", "arguments"),
    [
        ("ptz_adjust", {"pan_deg": "far"}),
        ("ptz_adjust", {"speed": 3}),
        ("ptz_adjust", {"zoom_percent": -100}),
        ("ptz_adjust", {"zoom_factor": 2, "zoom_full": "in"}),
        ("ptz_adjust", {"zoom_factor": 2, "zoom_percent": 50}),
        ("go_to_preset", {"name": "moon"}),
        ("count_pointing", {"object_of_interest": "cars", "view_type": "sideways"}),
        ("track_object", {"object_of_interest": "van", "duration": 3, "unit": "fortnights"}),
        ("track_object", {"object_of_interest": "van", "duration": -3}),
        ("take_image", {"name": "x"}),
    ],
)
def test_wrong_arguments_are_reported_and_the_row_still_runs(tmp_path: Path, tool: str, arguments: dict[str, Any]) -> None:
    result = import_rows(
        tmp_path, {"expected_tool_order_json": json.dumps([tool]), "expected_tool_args_json": json.dumps([arguments])}
    )
    assert "wrong-arguments" in kinds(result)
    assert len(result.tasks) == 1


def test_one_tool_is_expected_several_times(tmp_path: Path) -> None:
    result = import_rows(
        tmp_path,
        {
            "expected_tool_order_json": '["ptz_adjust", "ptz_adjust"]',
            "expected_tool_args_json": '{"ptz_adjust": [{"pan_deg": 5}, {"pan_deg": 6}]}',
        },
    )
    assert [call.arguments["pan_deg"].equals for call in result.tasks[0].calls] == [5, 6]


@pytest.mark.parametrize(
    ("order", "arguments", "kind", "detail"),
    [
        (["ptz_adjust", 5], None, "unknown-tool", "5 names no tool"),
        (["ptz_adjust", None], None, "unknown-tool", "null names no tool"),
        (["ptz_adjust", True], None, "unknown-tool", "true names no tool"),
        (["ptz_adjust", {"tool": 7}], None, "unknown-tool", '{"tool": 7} names no tool'),
        (["count_pointing"], {"object_of_interest": ["a", "b"]}, "wrong-arguments", '["a", "b"], which is not text'),
        (["count_pointing"], [{"object_of_interest": 5}], "wrong-arguments", "object_of_interest is 5, which is not text"),
        (["count_pointing"], {"object_of_interest": "a", "name": "b"}, "unchecked-argument", 'name is "b", but object_of_interest'),
        (["count_pointing"], {"ptz_adjust": {"pan_deg": 5}}, "unchecked-argument", "ptz_adjust: "),
        (["count_pointing"], [{}, {"pan_deg": 5}], "unchecked-argument", '{"pan_deg": 5} (number 2)'),
        (["count_pointing"], ["cars"], "unchecked-argument", '"cars" (number 1)'),
        (["count_pointing"], {"count_pointing": [{}, {"view": "full"}]}, "unchecked-argument", 'count_pointing: {"view": "full"}'),
        (["count_pointing", "take_image"], {"count_pointing": {}, "take_image": 3}, "unchecked-argument", "3 is not a set"),
        (None, {"pan_deg": 5}, "unchecked-argument", '{"pan_deg": 5}: the row expects no call'),
        (["count_pointing"], 7, "unchecked-argument", '"7" (number 1)'),
    ],
)
def test_unused_parts_are_reported(tmp_path: Path, order: Any, arguments: Any, kind: str, detail: str) -> None:
    cells = {"expected_tool_order_json": json.dumps(order), "expected_tool_args_json": json.dumps(arguments)}
    result = import_rows(tmp_path, cells)
    found = [finding for finding in result.findings[result.rows[0].line] if detail in finding.detail]
    assert [finding.kind for finding in found] == [kind], result.findings
    assert len(result.tasks) == 1


def test_used_parts_are_not_reported(tmp_path: Path) -> None:
    """Arguments may be given by position, by tool, by number, and without a name for a single call."""
    both = '["count_pointing", "ptz_adjust"]'
    for order, arguments in (
        (both, [{"object_of_interest": "cars"}, {"pan_deg": 5}]),
        (both, [{"object_of_interest": "cars"}, None]),
        (both, {"count_pointing": {"object_of_interest": "cars"}, "ptz_adjust": [{"pan_deg": 5}]}),
        (both, {"0": {"object_of_interest": "cars"}, "1": {"pan_deg": 5}}),
        ('["count_pointing"]', {"object_of_interest": "cars", "view_type": "full"}),
        ('["query_answer"]', {"instruction": "what?", "object_of_interest": "van"}),
    ):
        result = import_rows(tmp_path, {"expected_tool_order_json": order, "expected_tool_args_json": json.dumps(arguments)})
        assert not kinds(result) & {"wrong-arguments", "unknown-tool", "unchecked-argument"}, (arguments, result.findings)


def task_with(tmp_path: Path, tools: Sequence[str], arguments: object = "", **cells: str) -> ImportedTask:
    defaults = {
        "expected_tool_order_json": json.dumps(tools),
        "expected_tool_args_json": json.dumps(arguments) if arguments else "",
    }
    return import_rows(tmp_path, {**defaults, **cells}).tasks[0]


PRESET_CALL, COUNT_CALL = ("go_to_preset", {"name": "highway"}), count_step(5)


@pytest.mark.parametrize(
    ("cells", "steps", "passed"),
    [
        ({}, [PRESET_CALL, COUNT_CALL], True),
        ({}, [COUNT_CALL, PRESET_CALL], True),
        ({"multi_step_mode": "ordered"}, [PRESET_CALL, COUNT_CALL], True),
        ({"multi_step_mode": "ordered"}, [COUNT_CALL, PRESET_CALL], False),
        ({}, [PRESET_CALL], False),
        ({}, [], False),
        ({}, [PRESET_CALL, COUNT_CALL, ("take_image", {})], True),
        ({"required_tools_policy": "exact"}, [PRESET_CALL, COUNT_CALL, ("take_image", {})], False),
        ({"required_tools_policy": "exact"}, [PRESET_CALL, COUNT_CALL], True),
        ({"required_tools_policy": "any_of"}, [COUNT_CALL], True),
        ({"required_tools_policy": "any_of"}, [("take_image", {})], False),
        ({"required_tools_policy": "optional"}, [], None),
        ({}, [("go_to_preset", {"name": "gate"}), COUNT_CALL], False),
        ({"args_check": "off"}, [("go_to_preset", {"name": "gate"}), COUNT_CALL], True),
        ({}, [("go_to_preset", {"name": "highway"}, {"error": "no"}), COUNT_CALL], False),
    ],
)
def test_check_of_required_calls(tmp_path: Path, cells: dict[str, str], steps: list[Any], passed: bool | None) -> None:
    task = task_with(tmp_path, ["go_to_preset", "count_pointing"], {"go_to_preset": {"name": "Highway"}}, **cells)
    check = check_imported_calls(task, play(steps, "5"))
    assert (check.name, check.passed) == ("calls", passed)
    assert check.reason


@pytest.mark.parametrize("zoom", [{"zoom_percent": 0}, {"zoom_factor": 1}, {}])
def test_an_expected_zoom_of_zero_is_met_by_a_call_without_zoom(tmp_path: Path, zoom: dict[str, Any]) -> None:
    arguments = json.dumps([{"pan_deg": 20, "tilt_deg": 0, **zoom}])
    result = import_rows(tmp_path, {"expected_tool_order_json": '["ptz_adjust"]', "expected_tool_args_json": arguments})
    (task,) = result.tasks
    for extra, passed in (
        ({}, True),
        ({"zoom_percent": 0.0}, True),
        ({"zoom_factor": 2.0}, not zoom),
        ({"zoom_limit": "in"}, not zoom),
    ):
        check = check_imported_calls(task, play([("adjust_ptz", {"pan_deg": 20.0, **extra})], "Done."))
        assert check.passed is passed, (extra, check.reason)


def test_without_expected_calls_the_check_has_no_result(tmp_path: Path) -> None:
    assert check_imported_calls(task_with(tmp_path, []), play([COUNT_CALL], "5")).passed is None

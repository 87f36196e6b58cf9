"""Sessions: asking, streaming, cancelling, closing, and the tools as methods."""

from __future__ import annotations

import asyncio
import inspect
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

import scope_ptz
from scope_ptz.api.async_scope import AsyncScope
from scope_ptz.api.scope import Scope
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import ConfigError, InputError, PerceptionError, ScopeError, ToolCallError, TraceError
from scope_ptz.simulator.pack import Scene
from scope_ptz.tools.registry import TOOLS
from tests.agent.scripted import ScriptedPerception, ScriptedPlanner, answer, calls
from tests.api.sessions import WaitingPlanner, counting_planner, open_session, session_arguments


def test_a_run_has_typed_attributes(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope:
        run = scope.ask("count the things")
    assert (run.outcome, run.answer, run.ok, str(run)) == ("answered", "There are 3.", True, "There are 3.")
    (call,) = run.calls
    assert (call.name, call.ok, call.result and call.result["count"], call.step) == ("count_objects", True, 3, 1)
    assert run.pose == run.start == call.pose
    assert run.timings.total_s > 0
    assert run.folder is None
    assert run.picture(run.pictures[0]).size == run.filmstrip.resize(run.picture(run.pictures[0]).size).size


def test_a_failed_call_has_a_reason(analytic_scene: Scene) -> None:
    planner = ScriptedPlanner(calls(("fly", {})), answer("I cannot fly."))
    with open_session(analytic_scene, planner) as scope:
        (call,) = scope.ask("fly").calls
    assert not call.ok
    assert call.result is None
    assert call.fault == "bad_call"
    assert call.message == call.error
    assert "There is no tool 'fly'" in str(call)


def test_the_planner_gets_earlier_runs_until_they_are_cleared(analytic_scene: Scene) -> None:
    planner = counting_planner()
    with open_session(analytic_scene, planner) as scope:
        scope.ask("first")
        scope.ask("second")
        assert [turn.instruction for turn in planner.states[-1].conversation] == ["first"]
        scope.forget()
        scope.ask("third")
        assert planner.states[-1].conversation == ()
        assert [run.instruction for run in scope.runs] == ["first", "second", "third"]


def test_a_stream_yields_events_and_ends_with_the_run(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope:
        events = list(scope.stream("count"))
        assert [event.kind for event in events] == ["started", "decided", "called", "decided", "ended"]
        assert events[-1].run is scope.runs[-1]
        assert events[2].call == scope.runs[-1].calls[0]
        assert all(str(event).startswith(event.kind) for event in events)


def test_leaving_a_stream_early_cancels_the_run(analytic_scene: Scene) -> None:
    with open_session(analytic_scene, WaitingPlanner()) as scope:
        for event in scope.stream("count"):
            assert event.kind == "started"
            break
        assert [run.outcome for run in scope.runs] == ["cancelled"]
        assert scope.pose() == scope.runs[0].pose


def test_errors_of_a_stream_reach_the_caller(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope, pytest.raises(InputError, match="empty"):
        list(scope.stream("  "))


def test_frames_can_be_taken_during_a_run_but_a_second_run_is_refused(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope:
        for event in scope.stream("count"):
            if event.kind == "started":
                assert scope.frame().image.ndim == 3
        with open_session(analytic_scene, WaitingPlanner()) as other:
            for _ in other.stream("count"):
                for attempt in (lambda: other.ask("another"), lambda: other.move(pan_deg=1), lambda: list(other.stream("more"))):
                    with pytest.raises(InputError, match="in progress"):
                        attempt()
                break


def cancel_when(event: threading.Event, scope: Scope) -> None:
    """Cancel from another thread as soon as an event is set."""

    def cancel() -> None:
        event.wait()
        scope.cancel()

    threading.Thread(target=cancel).start()


def test_cancel_from_another_thread_ends_the_run(analytic_scene: Scene) -> None:
    planner = WaitingPlanner()
    with open_session(analytic_scene, planner) as scope:
        cancel_when(planner.asked, scope)
        run = scope.ask("wait")
    assert run.outcome == "cancelled"
    assert not run.ok


def test_cancel_without_a_run_changes_nothing(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope:
        scope.cancel()
        assert scope.ask("count").ok


def test_ctrl_c_cancels_the_run_and_leaves_a_complete_trace(analytic_scene: Scene, tmp_path: Path) -> None:
    planner = WaitingPlanner()
    main = threading.main_thread().ident
    assert main is not None

    def interrupt() -> None:
        planner.asked.wait()
        signal.pthread_kill(main, signal.SIGINT)

    with open_session(analytic_scene, planner, runs_dir=tmp_path) as scope:
        threading.Thread(target=interrupt).start()
        with pytest.raises(KeyboardInterrupt):
            scope.ask("wait")
        assert scope.runs[-1].outcome == "cancelled"
        scope.move(pan_deg=5)  # the session is still usable
    (folder,) = tmp_path.iterdir()
    assert scope_ptz.Run.load(folder).outcome == "cancelled"


def test_using_a_closed_session_is_an_error(analytic_scene: Scene) -> None:
    scope = open_session(analytic_scene)
    scope.close()
    scope.close()
    attempts: tuple[Callable[[], Any], ...] = (
        lambda: scope.ask("count"),
        lambda: scope.move(pan_deg=1),
        lambda: list(scope.stream("count")),
        scope.frame,
        scope.__enter__,
        lambda: scope.camera,
    )
    for attempt in attempts:
        with pytest.raises(InputError, match="closed"):
            attempt()
    scope.cancel()


def test_closing_cancels_a_run_in_progress(analytic_scene: Scene) -> None:
    scope = open_session(analytic_scene, WaitingPlanner())
    stream = scope.stream("wait")
    assert next(stream).kind == "started"
    scope.close()
    assert [run.outcome for run in scope.runs] == ["cancelled"]


def test_objects_of_the_caller_stay_open(analytic_scene: Scene) -> None:
    planner = WaitingPlanner()
    open_session(analytic_scene, planner).close()
    assert not planner.closed


def test_a_session_works_where_an_event_loop_is_running(analytic_scene: Scene) -> None:
    async def notebook_cell() -> str:
        with open_session(analytic_scene) as scope:
            return scope.ask("count").answer

    assert asyncio.run(notebook_cell()) == "There are 3."


@pytest.mark.full
def test_a_program_that_never_closes_its_session_ends(analytic_folder: Path) -> None:
    program = (
        "import scope_ptz, sys\n"
        "from pathlib import Path\n"
        "from scope_ptz.camera.simulated import SimulatedCamera\n"
        "from scope_ptz.simulator.pack import Scene\n"
        "scope = scope_ptz.open(SimulatedCamera(Scene(Path(sys.argv[1]))))\n"
        "print(scope.frame().width)\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", program, str(analytic_folder)], capture_output=True, text=True, timeout=60, check=False
    )
    assert (result.returncode, result.stderr) == (0, "")
    assert int(result.stdout) > 0


def test_runs_are_stored_in_the_runs_dir(analytic_scene: Scene, tmp_path: Path) -> None:
    with open_session(analytic_scene, runs_dir=tmp_path) as scope:
        run = scope.ask("count the things")
        with pytest.raises(InputError):
            scope.ask("x" * 5000)
        assert scope.picture(scope.take_image().file).size == (scope.frame().width, scope.frame().height)
    assert run.folder is not None
    assert (run.folder / "trace.jsonl").is_file()
    loaded = scope_ptz.Run.load(run.folder)
    assert (loaded.answer, loaded.calls, loaded.pictures) == (run.answer, run.calls, run.pictures)
    assert loaded.filmstrip.tobytes() == run.filmstrip.tobytes()
    assert len(list(tmp_path.iterdir())) == 2  # the run and the picture, but nothing for the rejected instruction


def test_a_run_in_memory_and_one_in_a_folder_have_the_same_pictures(analytic_scene: Scene, tmp_path: Path) -> None:
    with open_session(analytic_scene) as in_memory, open_session(analytic_scene, runs_dir=tmp_path) as on_disk:
        first, second = in_memory.ask("count"), on_disk.ask("count")
    assert first.pictures == second.pictures
    assert [first.picture(name).tobytes() for name in first.pictures] == [second.picture(n).tobytes() for n in second.pictures]


def test_a_missing_picture_is_an_error(analytic_scene: Scene) -> None:
    with open_session(analytic_scene) as scope:
        run = scope.ask("count")
        for name in ("pictures/009.png", "../../etc/passwd"):
            with pytest.raises(TraceError):
                run.picture(name)
            with pytest.raises(TraceError):
                scope.picture(name)


def test_a_trace_without_an_end_is_an_error(analytic_scene: Scene, tmp_path: Path) -> None:
    with open_session(analytic_scene, runs_dir=tmp_path) as scope:
        folder = scope.ask("count").folder
    assert folder is not None
    trace = folder / "trace.jsonl"
    trace.write_text("\n".join(trace.read_text().splitlines()[:-1]) + "\n")
    with pytest.raises(TraceError, match="is incomplete"):
        scope_ptz.Run.load(folder)


def test_tools_are_methods(analytic_scene: Scene) -> None:
    with open_session(analytic_scene, perception=ScriptedPerception(3)) as scope:
        start = scope.pose()
        assert scope.move(pan_deg=10).pose.pan_deg == pytest.approx(start.pan_deg + 10)
        assert scope.move_to(pan_deg=-5).pan_deg == -5
        assert scope.go_home().pose.pan_deg == pytest.approx(start.pan_deg)
        assert scope.count_objects("things").count == 3
        assert scope.query_answer("how many?").answer == "3"
        assert scope.go_to_preset(scope.get_presets().presets[0]).preset
        assert isinstance(scope.picture(scope.take_image().file), Image.Image)
        assert scope.runs == ()
        with pytest.raises(ToolCallError, match="zoom"):
            scope.move(zoom_factor=2, zoom_percent=50)
        with pytest.raises(InputError, match="no preset"):
            scope.go_to_preset("nowhere")
        with pytest.raises(InputError, match="The pose is invalid"):
            scope.move_to(zoom=-1)
        with pytest.raises(AttributeError, match="fly"):
            scope.fly()


@pytest.mark.parametrize("name", TOOLS)
def test_every_tool_has_a_method_with_its_arguments(name: str) -> None:
    fields = TOOLS[name].arguments.model_fields
    for kind in (Scope, AsyncScope):
        parameters = dict(inspect.signature(getattr(kind, name)).parameters)
        del parameters["self"]
        assert list(parameters) == list(fields)
        required = {key for key, field in fields.items() if field.is_required()}
        assert {key for key, p in parameters.items() if p.default is p.empty} == required
        assert all(parameters[key].default == field.default for key, field in fields.items() if key not in required)


def test_a_tool_without_a_declared_method_can_be_called_as_a_method(analytic_scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(TOOLS._tools, "look_home", TOOLS["go_home"])
    with open_session(analytic_scene) as scope:
        assert "look_home" in dir(scope)
        assert scope.look_home().message


def test_the_async_session_has_the_same_names() -> None:
    def public(kind: type) -> set[str]:
        return {name for name in vars(kind) if not name.startswith("_")}

    assert public(Scope) == public(AsyncScope) - {"run_with_events"}
    for name in public(Scope):
        if callable(getattr(Scope, name)):
            parameters = inspect.signature(getattr(Scope, name)).parameters
            assert list(parameters) == list(inspect.signature(getattr(AsyncScope, name)).parameters), name
    assert inspect.signature(scope_ptz.open).parameters == inspect.signature(scope_ptz.open_async).parameters


def test_the_async_session(analytic_scene: Scene) -> None:
    async def work() -> None:
        async with scope_ptz.open_async(**session_arguments(analytic_scene)) as scope:
            assert (await scope.ask("count")).ok
            assert [event.kind async for event in scope.stream("count")][-1] == "ended"
            assert (await scope.move(pan_deg=3)).pose == (await scope.adjust_ptz()).pose
            assert (await scope.frame()).width > 0
        with pytest.raises(InputError, match="closed"):
            await scope.ask("count")
        with pytest.raises(InputError, match="closed"):
            await scope
        later = await scope_ptz.open_async(**session_arguments(analytic_scene))
        await later.close()
        await later.close()

    asyncio.run(work())


def test_an_async_session_must_be_opened(analytic_scene: Scene) -> None:
    with pytest.raises(InputError, match="async with"):
        asyncio.run(scope_ptz.open_async(**session_arguments(analytic_scene)).ask("count"))


def test_leaving_an_async_stream_early_cancels_the_run(analytic_scene: Scene) -> None:
    async def work() -> None:
        async with scope_ptz.open_async(**session_arguments(analytic_scene, WaitingPlanner())) as scope:
            stream = scope.stream("wait")
            async for _ in stream:
                break
            await stream.aclose()  # type: ignore[attr-defined]
            assert [run.outcome for run in scope.runs] == ["cancelled"]

    asyncio.run(work())


def test_cancelling_a_task_cancels_its_run(analytic_scene: Scene) -> None:
    async def work() -> None:
        planner = WaitingPlanner()
        async with scope_ptz.open_async(**session_arguments(analytic_scene, planner)) as scope:
            task = asyncio.create_task(scope.ask("wait"))
            while not planner.asked.is_set():  # noqa: ASYNC110 - a threading.Event cannot be awaited
                await asyncio.sleep(0.001)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            assert [run.outcome for run in scope.runs] == ["cancelled"]

    asyncio.run(work())


def test_a_cancelled_tool_call_is_an_error(analytic_scene: Scene) -> None:
    class WaitingPerception(ScriptedPerception):
        asked = threading.Event()

        async def query(self, frame: Any, question: str) -> Any:
            self.asked.set()
            await asyncio.sleep(3600)

    perception = WaitingPerception()
    with open_session(analytic_scene, perception=perception) as scope:
        cancel_when(perception.asked, scope)
        with pytest.raises(ScopeError, match="cancelled"):
            scope.query_answer("what?")


def test_a_camera_without_ground_truth_has_no_default_perception(analytic_scene: Scene) -> None:
    from scope_ptz.camera.base import CameraInfo

    class Real(SimulatedCamera):
        @property
        def info(self) -> CameraInfo:
            info = super().info
            return CameraInfo("real", info.limits, info.optics, info.frame_width, info.frame_height, simulated=False)

    with scope_ptz.open(Real(analytic_scene)) as scope:
        assert scope.ask("pan right 5 degrees").ok
        with pytest.raises(PerceptionError, match="no perception"):
            scope.count_objects("cars")
    with pytest.raises(InputError, match="has none"):
        scope_ptz.open(Real(analytic_scene), perception="ground-truth")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"camera": "nowhere"}, "no scene 'nowhere'"),
        ({"planner": "nobody"}, "no planner 'nobody'"),
        ({"perception": "nobody"}, "no perception 'nobody'"),
        ({"planner": ScriptedPlanner}, "not the class itself"),
        ({"planner": 3}, "must be a name or"),
        ({"camera": 3}, "must be a name or"),
        ({"planner": ScriptedPlanner(), "planner_url": "http://127.0.0.1:1"}, "cannot be combined with planner_url"),
        ({"perception": ScriptedPerception(), "pair": "grammar+noisy"}, "cannot be combined with pair"),
        ({"max_steps": 0}, "max_steps is invalid"),
        ({"time_budget_s": -1}, "time_budget_s is invalid"),
        ({"planner_options": {"temperature": 0}}, "grammar"),
    ],
)
def test_wrong_options_are_reported(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        scope_ptz.open(**({"camera": "highway-works"} | wrong))


def test_scene_options_do_not_apply_to_a_camera_object(analytic_scene: Scene) -> None:
    with pytest.raises(InputError, match="viewpoint"):
        open_session(analytic_scene, viewpoint="mast")


def test_an_unknown_model_server_is_a_clear_error() -> None:
    with pytest.raises(ConfigError, match="qwen3-4b"):
        scope_ptz.open("highway-works", planner="qwen3-4b")

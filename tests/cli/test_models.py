"""``scope models``, and models as planner and perception of ``scope ask``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import SCENE, Scope
from tests.support.misbehaving import MODEL, Misbehaving, Request, Say, good

KEY = "sk-very-secret-key-0123456789"


def follow_script(request: Request) -> Say:
    """Count the balls, then answer with the result of the tool."""
    results = [m for m in request.data["messages"] if m["role"] == "tool"]
    if not results:
        return Say(text="", tool_calls=(("count_objects", {"description": "balls", "view": "current"}),))
    return Say(text="I looked.")


def ask(scope: Scope, *options: str) -> Any:
    return scope("ask", "how many balls are visible?", "--scene", SCENE, "--json", *options)


def test_the_list_can_be_filtered(scope: Scope) -> None:
    everything = json.loads(scope("models", "--json").out)
    small = json.loads(scope("models", "--memory", "8", "--role", "planner", "--json").out)
    assert len([m for m in everything if m["origin"] == "paper"]) == 11
    assert {m["name"] for m in small} < {m["name"] for m in everything}
    assert all(m["least_memory_gb"] <= 8 and "planner" in m["roles"] for m in small)
    assert "qwen3.5-4b" in scope("models", "--memory", "8").out


def test_a_model_is_shown_with_its_commands(scope: Scope) -> None:
    run_result = scope("models", "show", "Qwen3-30B-A3B-Instruct-2507")
    assert run_result.code == 0
    assert "vllm serve Qwen/Qwen3-30B-A3B-Instruct-2507" in run_result.out
    assert "computed, not measured" in run_result.out
    assert scope("models", "show", "qwen3-32b", "--json").code == 0


def test_only_the_serve_command_is_printed(scope: Scope) -> None:
    assert scope("models", "serve-command", "qwen3-4b", "--server", "ollama").out.splitlines() == [
        "OLLAMA_CONTEXT_LENGTH=16384 ollama serve &",
        "ollama pull qwen3:4b-instruct-2507-q4_K_M",
    ]
    assert scope("models", "serve-command", "moondream3").out.startswith("moondream-station")
    assert scope("models", "serve-command", "qwen3-4b-fp8", "--server", "ollama").code == 2


def test_the_nineteen_pairs(scope: Scope) -> None:
    pairs = json.loads(scope("models", "pairs", "--json").out)
    assert sum(p["origin"] == "paper" for p in pairs) == 19
    assert "73.8 %" in scope("models", "pairs").out


def test_a_pair_by_name_on_two_servers(scope: Scope) -> None:
    with Misbehaving(then=good(follow_script)) as planning, Misbehaving() as perception:
        run_result = ask(
            scope, "--pair", "qwen3-30b-a3b+moondream3", "--planner-url", planning.url, "--perception-url", perception.url
        )
        assert run_result.code == 0, run_result.err
        assert MODEL in run_result.err  # the server serves another model, which is reported
        assert [r.path.rpartition("/")[2] for r in perception.requests] == ["detect"]
    (line,) = run_result.out.splitlines()
    output = json.loads(line)
    assert output["answer"] == "I looked."
    assert output["tool_calls"][0]["result"]["count"] == 1
    started = json.loads((Path(output["run_dir"]) / "trace.jsonl").read_text().splitlines()[0])
    assert (started["planner"], started["perception"]) == (MODEL, "moondream3")


@pytest.mark.parametrize("suffix", ["", "/v1"])
def test_a_server_works_without_a_model_name(scope: Scope, suffix: str) -> None:
    with Misbehaving(then=good(follow_script)) as server:
        run_result = ask(scope, "--planner-url", server.root + suffix)
        assert (run_result.code, run_result.err, run_result.json["outcome"]) == (0, "", "answered")
        assert server.requests[-1].data["model"] == MODEL


def test_one_model_can_be_planner_and_perception(scope: Scope) -> None:
    box = '[{"bbox_2d": [100, 100, 200, 300], "label": "ball"}]'

    def both(request: Request) -> Say:
        return follow_script(request) if request.data.get("tools") else Say(text=box)

    with Misbehaving(then=good(both)) as server:
        run_result = ask(scope, "--pair", "qwen3.5-9b", "--planner-url", server.url)
        assert run_result.code == 0, run_result.err
        assert run_result.json["tool_calls"][0]["result"]["count"] == 1
        planner_request = next(r for r in server.requests if r.data.get("tools"))
        assert "image_url" in json.dumps(planner_request.data["messages"])
        perception_request = next(r for r in server.requests if r.chat and not r.data.get("tools"))
        assert perception_request.data["chat_template_kwargs"] == {"enable_thinking": False}


def test_models_of_the_user_and_their_urls(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "mine.yaml"
    monkeypatch.setenv("SCOPE_MODELS", str(file))
    with Misbehaving(then=good(follow_script)) as server:
        key = tmp_path / "key"
        key.write_text(KEY + "\n")
        file.write_text(
            f"models: {{mine: {{repo: {MODEL}, roles: [planner], size_b: 1, active_b: 1, precision: bf16, "
            "context: 4096,"
            f" licence: MIT, url: '{server.url}', key_file: '{key}'}}}}"
        )
        assert ask(scope, "--pair", "mine+ground-truth").code == 0
        run_result = ask(scope, "--planner", "mine")
        assert (run_result.code, run_result.err) == (0, "")
        assert run_result.json["tool_calls"][0]["result"]["count"] == 3
        assert server.requests[-1].headers["authorization"] == f"Bearer {KEY}"
        assert KEY not in run_result.out + scope("models", "show", "mine", "--json").out
        with Misbehaving(then=good(follow_script)) as stranger:
            assert ask(scope, "--planner", "mine", "--planner-url", stranger.url).code == 0
            assert not any("authorization" in r.headers for r in stranger.requests)


def test_keys_are_read_from_the_environment_and_not_stored(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_PLANNER_KEY", KEY)
    with Misbehaving(then=good(follow_script)) as planning, Misbehaving() as perception:
        run_result = ask(scope, "--planner-url", planning.url, "--perception", "moondream2", "--perception-url", perception.url)
        assert run_result.code == 0
        assert all(r.headers["authorization"] == f"Bearer {KEY}" for r in planning.requests)
        assert not any(KEY in str(r.headers) for r in perception.requests)
    traces = "".join(p.read_text() for p in tmp_path.rglob("*.jsonl"))
    assert KEY not in traces + run_result.out + run_result.err


def test_urls_from_the_environment_apply_to_models_only(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    with Misbehaving(then=good(follow_script)) as server:
        monkeypatch.setenv("SCOPE_PLANNER_URL", server.url)
        assert ask(scope).json["answer"] != "I looked."  # The built-in planner stays the default
        assert server.requests == []
        assert ask(scope, "--planner", "qwen3-4b").json["answer"] == "I looked."


CUSTOM_BACKEND = """
from scope_ptz.perception.backends import moondream

def make(spec):
    spec.needed_endpoint()
    return moondream.make(spec)
"""


def test_a_custom_backend_gets_the_url_of_its_model_or_of_the_environment(
    scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import scope_ptz.perception.backends as backends

    (tmp_path / "our_perception.py").write_text(CUSTOM_BACKEND)
    monkeypatch.setattr(backends, "__path__", [*backends.__path__, str(tmp_path)])
    file = tmp_path / "mine.yaml"
    with Misbehaving() as server:
        file.write_text(
            "models: {mine: {repo: a/b, roles: [perception], backend: our_perception, size_b: 1, active_b: 1, precision: bf16, "
            "context: 4096,"
            f" licence: MIT, url: '{server.url}'}}}}"
        )
        assert ask(scope, "--perception", "our_perception").code == 2
        monkeypatch.setenv("SCOPE_MODELS", str(file))
        assert ask(scope, "--perception", "mine").json["tool_calls"][0]["error"] is None
        monkeypatch.setenv("SCOPE_PERCEPTION_URL", server.url)
        assert ask(scope, "--perception", "our_perception").json["tool_calls"][0]["error"] is None
        assert len(server.requests) == 2


def test_a_server_with_several_models_requires_a_name(scope: Scope) -> None:
    from tests.support.misbehaving import body

    listing = body(json.dumps({"data": [{"id": "a"}, {"id": "b"}]}))
    with Misbehaving([listing]) as server:
        run_result = ask(scope, "--planner-url", server.url)
    assert run_result.code == 2
    assert "--planner-model" in run_result.err


INVALID_OPTIONS = {
    "pair and planner": ("--pair", "qwen3-4b+moondream2", "--planner", "grammar"),
    "no address": ("--planner", "qwen3-4b"),
    "no perception address": ("--perception", "moondream2"),
    "perception backend as the planner": ("--pair", "ground-truth+grammar"),
    "a built-in and an unknown one": ("--pair", "grammar+moondream9"),
    "an unknown pair": ("--pair", "qwen3-4b+moondream9", "--planner-url", "http://127.0.0.1:9/v1"),
    "a planner that cannot plan": ("--planner", "moondream2", "--planner-url", "http://127.0.0.1:9/v1"),
    "an address with a password": ("--planner-url", "http://me:secret@127.0.0.1/v1"),
    "not a URL": ("--planner-url", "gpu-box"),
    "a missing key file": ("--planner-url", "http://127.0.0.1:9/v1", "--planner-key-file", "/nowhere/key"),
    "an unknown option": ("--planner-url", "http://127.0.0.1:9/v1", "--planner-option", "hurry=1"),
    "an option without a value": ("--planner-url", "http://127.0.0.1:9/v1", "--planner-option", "hurry"),
    "the grammar has no server": ("--planner", "grammar", "--planner-url", "http://127.0.0.1:9/v1"),
    "ground truth has no server": ("--perception", "noisy", "--perception-url", "http://127.0.0.1:9/v1"),
    "a reader with ground truth": ("--reader", "rapidocr"),
}


@pytest.mark.parametrize("case", INVALID_OPTIONS)
def test_invalid_options_give_one_line_and_exit_code_2(scope: Scope, case: str) -> None:
    run_result = ask(scope, *INVALID_OPTIONS[case])
    assert (run_result.code, run_result.err.count("\n")) == (2, 1)
    assert "secret" not in run_result.err


def test_a_dead_server_is_a_planner_error(scope: Scope) -> None:
    run_result = ask(scope, "--planner-url", "http://127.0.0.1:9/v1", "--planner-model", "x")
    assert (run_result.code, run_result.json["outcome"]) == (1, "planner_error")
    assert "cannot be reached" in run_result.json["answer"]


def test_perception_can_be_composed(scope: Scope) -> None:
    pytest.importorskip("rapidocr")
    with Misbehaving() as perception:
        run_result = scope(
            "ask", "what colour is the van?", "--scene", SCENE, "--json",
            "--perception", "moondream3", "--perception-url", perception.url, "--reader", "rapidocr",
        )  # fmt: skip
        assert run_result.code == 0, run_result.err
        assert "white van" in run_result.json["answer"].lower()

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
    done = scope("models", "show", "Qwen3-30B-A3B-Instruct-2507")
    assert done.code == 0
    assert "vllm serve Qwen/Qwen3-30B-A3B-Instruct-2507" in done.out
    assert "computed, not measured" in done.out
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
    with Misbehaving(then=good(follow_script)) as brain, Misbehaving() as perception:
        done = ask(scope, "--pair", "qwen3-30b-a3b+moondream3", "--planner-url", brain.url, "--perception-url", perception.url)
        assert done.code == 0, done.err
        assert MODEL in done.err  # the server serves another model, and that is said
        assert [r.path.rpartition("/")[2] for r in perception.requests] == ["detect"]
    (line,) = done.out.splitlines()
    said = json.loads(line)
    assert said["answer"] == "I looked."
    assert said["tool_calls"][0]["result"]["count"] == 1
    started = json.loads((Path(said["run_dir"]) / "trace.jsonl").read_text().splitlines()[0])
    assert (started["planner"], started["perception"]) == (MODEL, "moondream3")


@pytest.mark.parametrize("cut", ["", "/v1"])
def test_a_server_works_without_a_model_name(scope: Scope, cut: str) -> None:
    with Misbehaving(then=good(follow_script)) as server:
        done = ask(scope, "--planner-url", server.root + cut)
        assert (done.code, done.err, done.json["outcome"]) == (0, "", "answered")
        assert server.requests[-1].data["model"] == MODEL


def test_one_model_can_be_planner_and_perception(scope: Scope) -> None:
    box = '[{"bbox_2d": [100, 100, 200, 300], "label": "ball"}]'

    def both(request: Request) -> Say:
        return follow_script(request) if request.data.get("tools") else Say(text=box)

    with Misbehaving(then=good(both)) as server:
        done = ask(scope, "--pair", "qwen3.5-9b", "--planner-url", server.url)
        assert done.code == 0, done.err
        assert done.json["tool_calls"][0]["result"]["count"] == 1
        planning = next(r for r in server.requests if r.data.get("tools"))
        assert "image_url" in json.dumps(planning.data["messages"])
        looking = next(r for r in server.requests if r.chat and not r.data.get("tools"))
        assert looking.data["chat_template_kwargs"] == {"enable_thinking": False}


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
        done = ask(scope, "--planner", "mine")
        assert (done.code, done.err) == (0, "")
        assert done.json["tool_calls"][0]["result"]["count"] == 3
        assert server.requests[-1].headers["authorization"] == f"Bearer {KEY}"
        assert KEY not in done.out + scope("models", "show", "mine", "--json").out
        with Misbehaving(then=good(follow_script)) as stranger:
            assert ask(scope, "--planner", "mine", "--planner-url", stranger.url).code == 0
            assert not any("authorization" in r.headers for r in stranger.requests)


def test_keys_are_read_from_the_environment_and_not_stored(scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SCOPE_PLANNER_KEY", KEY)
    with Misbehaving(then=good(follow_script)) as brain, Misbehaving() as perception:
        done = ask(scope, "--planner-url", brain.url, "--perception", "moondream2", "--perception-url", perception.url)
        assert done.code == 0
        assert all(r.headers["authorization"] == f"Bearer {KEY}" for r in brain.requests)
        assert not any(KEY in str(r.headers) for r in perception.requests)
    written = "".join(p.read_text() for p in tmp_path.rglob("*.jsonl"))
    assert KEY not in written + done.out + done.err


def test_urls_from_the_environment_apply_to_models_only(scope: Scope, monkeypatch: pytest.MonkeyPatch) -> None:
    with Misbehaving(then=good(follow_script)) as server:
        monkeypatch.setenv("SCOPE_PLANNER_URL", server.url)
        assert ask(scope).json["answer"] != "I looked."  # The built-in planner stays the default
        assert server.requests == []
        assert ask(scope, "--planner", "qwen3-4b").json["answer"] == "I looked."


ASKS_A_SERVER = """
from scope_ptz.perception.backends import moondream

def make(spec):
    spec.needed_endpoint()
    return moondream.make(spec)
"""


def test_a_custom_backend_gets_the_url_of_its_model_or_of_the_environment(
    scope: Scope, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import scope_ptz.perception.backends as backends

    (tmp_path / "our_eyes.py").write_text(ASKS_A_SERVER)
    monkeypatch.setattr(backends, "__path__", [*backends.__path__, str(tmp_path)])
    file = tmp_path / "mine.yaml"
    with Misbehaving() as server:
        file.write_text(
            "models: {mine: {repo: a/b, roles: [perception], backend: our_eyes, size_b: 1, active_b: 1, precision: bf16, "
            "context: 4096,"
            f" licence: MIT, url: '{server.url}'}}}}"
        )
        assert ask(scope, "--perception", "our_eyes").code == 2
        monkeypatch.setenv("SCOPE_MODELS", str(file))
        assert ask(scope, "--perception", "mine").json["tool_calls"][0]["error"] is None
        monkeypatch.setenv("SCOPE_PERCEPTION_URL", server.url)
        assert ask(scope, "--perception", "our_eyes").json["tool_calls"][0]["error"] is None
        assert len(server.requests) == 2


def test_a_server_with_several_models_requires_a_name(scope: Scope) -> None:
    from tests.support.misbehaving import body

    listing = body(json.dumps({"data": [{"id": "a"}, {"id": "b"}]}))
    with Misbehaving([listing]) as server:
        done = ask(scope, "--planner-url", server.url)
    assert done.code == 2
    assert "--planner-model" in done.err


WRONG = {
    "pair and planner": ("--pair", "qwen3-4b+moondream2", "--planner", "grammar"),
    "no address": ("--planner", "qwen3-4b"),
    "no perception address": ("--perception", "moondream2"),
    "perception backend as the planner": ("--pair", "ground-truth+grammar"),
    "a built-in and an unknown one": ("--pair", "grammar+moondream9"),
    "an unknown pair": ("--pair", "qwen3-4b+moondream9", "--planner-url", "http://127.0.0.1:9/v1"),
    "a planner that cannot plan": ("--planner", "moondream2", "--planner-url", "http://127.0.0.1:9/v1"),
    "an address with a password": ("--planner-url", "http://me:secret@127.0.0.1/v1"),
    "no address at all": ("--planner-url", "gpu-box"),
    "a key file that is not there": ("--planner-url", "http://127.0.0.1:9/v1", "--planner-key-file", "/nowhere/key"),
    "an unknown option": ("--planner-url", "http://127.0.0.1:9/v1", "--planner-option", "hurry=1"),
    "an option without a value": ("--planner-url", "http://127.0.0.1:9/v1", "--planner-option", "hurry"),
    "the grammar has no server": ("--planner", "grammar", "--planner-url", "http://127.0.0.1:9/v1"),
    "ground truth has no server": ("--perception", "noisy", "--perception-url", "http://127.0.0.1:9/v1"),
    "a reader beside ground truth": ("--reader", "rapidocr"),
}


@pytest.mark.parametrize("case", WRONG)
def test_invalid_options_give_one_line_and_exit_code_2(scope: Scope, case: str) -> None:
    done = ask(scope, *WRONG[case])
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert "secret" not in done.err


def test_a_dead_server_is_a_planner_error(scope: Scope) -> None:
    done = ask(scope, "--planner-url", "http://127.0.0.1:9/v1", "--planner-model", "x")
    assert (done.code, done.json["outcome"]) == (1, "planner_error")
    assert "cannot be reached" in done.json["answer"]


def test_perception_can_be_composed(scope: Scope) -> None:
    pytest.importorskip("rapidocr")
    with Misbehaving() as perception:
        done = scope(
            "ask", "what colour is the van?", "--scene", SCENE, "--json",
            "--perception", "moondream3", "--perception-url", perception.url, "--reader", "rapidocr",
        )  # fmt: skip
        assert done.code == 0, done.err
        assert "white van" in done.json["answer"].lower()

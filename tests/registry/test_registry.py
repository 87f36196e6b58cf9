"""The registry: the paper's model table, and the entries of users."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.perception.backends import backend_names
from scope_ptz.perception.models.coordinates import CONVENTIONS
from scope_ptz.planner.chat.families import reasoning_switch
from scope_ptz.registry import Registry, load_registry

# The paper's table of models: name, total size, active parameters (billions), precision.
PAPER_PLANNERS = [
    ("Qwen3-4B-Instruct-2507", 4, 4, "fp16"),
    ("Qwen3-4B-Instruct-2507-FP8", 4, 4, "fp8"),
    ("Qwen3-30B-A3B-Instruct-2507", 30, 3, "fp16"),
    ("Qwen3-30B-A3B-Instruct-2507-FP8", 30, 3, "fp8"),
    ("Qwen3-32B-Instruct", 32, 32, "fp16"),
    ("Qwen3-Next-80B-A3B-Instruct", 80, 3, "fp16"),
    ("Qwen3-Next-80B-A3B-Instruct-FP8", 80, 3, "fp8"),
]
PAPER_EYES = [
    ("Moondream2-2025-06-21", 2, 2, "fp16"),
    ("Moondream2-4bit-2025-04-14", 2, 2, "int4"),
    ("Moondream3-preview-2025-09-18", 9, 2, "fp16"),
    ("Qwen2.5-VL-7B-Instruct", 7, 7, "fp16"),
]
# The paper's table of accuracies: the macro average by planner, for each perception model.
PLANNERS = ["qwen3-4b", "qwen3-4b-fp8", "qwen3-30b-a3b", "qwen3-30b-a3b-fp8", "qwen3-32b", "qwen3-next-80b-a3b"]
PAPER_AVERAGES = {
    "moondream2": [59.7, 60.3, 67.3, 69.6, 68.0, 70.6],
    "moondream2-4bit": [62.3, 61.3, 66.9, 65.7, 65.9, 66.8],
    "moondream3": [61.4, 62.6, 73.8, 69.1, 68.8, 69.3],
}


@pytest.fixture(scope="module")
def registry() -> Registry:
    return load_registry()


@pytest.mark.parametrize(("role", "table"), [("planner", PAPER_PLANNERS), ("perception", PAPER_EYES)])
def test_the_papers_models_match_its_table(registry: Registry, role: str, table: list[tuple[str, float, float, str]]) -> None:
    found = [
        (m.title, m.size_b, m.active_b, m.precision) for m in registry.models.values() if m.origin == "paper" and m.roles == (role,)
    ]
    assert found == table


def test_the_papers_nineteen_pairs(registry: Registry) -> None:
    expected = {
        f"{p}+{perception}": a for perception, averages in PAPER_AVERAGES.items() for p, a in zip(PLANNERS, averages, strict=True)
    }
    expected["qwen3-next-80b-a3b+qwen2.5-vl-7b"] = 68.3
    pairs = {p.name: p.paper_average for p in registry.pairs.values() if p.origin == "paper"}
    assert pairs == expected
    assert len(pairs) == 19
    assert not any(p.planner == "qwen3-next-80b-a3b-fp8" for p in registry.pairs.values())
    for name in pairs:
        pair = registry.pair(name)
        assert registry.model(pair.planner, "planner")
        assert registry.model(pair.perception, "perception")


def test_current_models_for_small_machines(registry: Registry) -> None:
    current = [m for m in registry.models.values() if m.origin == "current"]
    assert len(current) >= 10
    assert sum(m.min_memory_server()[1] <= 8 for m in current) >= 6
    assert sum(m.min_memory_server()[1] <= 16 and "planner" in m.roles for m in current) >= 8


def test_every_model_is_complete(registry: Registry) -> None:
    for model in registry.models.values():
        assert model.licence
        assert model.source
        assert model.serve, f"{model.name} cannot be served"
        assert model.memory_for() > 0
        assert model.family
        if "perception" in model.roles:
            assert model.coordinates in {*CONVENTIONS, "pixels"}
            assert model.backend in backend_names()
        if model.thinking in ("default", "always"):
            assert reasoning_switch(model.repo, "off", None).fields, f"nothing is known to keep {model.name} from thinking"
        if model.sees:
            assert model.backend == "openai_vision"
        for server in model.serve:
            for command in registry.commands(model, server):
                assert shlex.split(command)
                assert "{" not in command


def test_serve_commands_are_exact(registry: Registry) -> None:
    model = registry.model("qwen3-30b-a3b")
    assert registry.commands(model, "vllm") == (
        "vllm serve Qwen/Qwen3-30B-A3B-Instruct-2507 --port 8000 --max-model-len 16384"
        " --enable-auto-tool-choice --tool-call-parser hermes",
    )
    assert "ollama pull qwen3.5:4b" in registry.commands(registry.model("qwen3.5-4b"), "ollama")
    assert "qwen3_coder" in registry.commands(registry.model("qwen3.5-4b"), "vllm")[0]
    with pytest.raises(ConfigError, match="vllm, sglang"):
        registry.commands(registry.model("qwen3-4b-fp8"), "ollama")


def test_memory_is_parameters_times_bytes_plus_cache_plus_runtime(registry: Registry) -> None:
    model = registry.model("qwen3-30b-a3b")
    assert model.memory_for() == pytest.approx(30.5 * 2 + 96 * 1024 * 16384 / 1e9 + 1.5, abs=0.06)
    assert model.memory_for("llama.cpp") < model.memory_for("vllm") / 2


@pytest.mark.parametrize("name", ["qwen3-4b", "Qwen3-4B-Instruct-2507", "QWEN/Qwen3-4B-Instruct-2507"])
def test_models_are_found_by_their_names(registry: Registry, name: str) -> None:
    assert registry.model(name).name == "qwen3-4b"


def test_pairs_are_made_of_any_planner_and_perception(registry: Registry) -> None:
    pair = registry.pair("qwen3.5-4b+rapidocr")
    assert (pair.planner, pair.perception, pair.paper_average) == ("qwen3.5-4b", "rapidocr", None)
    both = registry.pair("qwen3.5-9b")
    assert both.planner == both.perception == "qwen3.5-9b"
    with pytest.raises(ConfigError, match="only a planner"):
        registry.pair("qwen3-4b")
    with pytest.raises(ConfigError, match="cannot be used for perception"):
        registry.pair("qwen3-4b+qwen3-4b")
    with pytest.raises(UnknownNameError, match="Did you mean 'qwen3-4b'"):
        registry.pair("qwen3-4c+moondream2")


OWN = """
servers:
  mine: {title: My server, command: ["serve {source} {flags}"], url: "http://localhost:9/v1"}
models:
  my-planner:
    repo: me/planner
    roles: [planner]
    size_b: 1
    active_b: 1
    precision: bf16
    context: 4096
    licence: MIT
    url: http://gpu:8000/v1
    serve:
      mine: {flags: "--json '{\\"a\\": {}}'"}
      vllm: {}
pairs:
  - {planner: my-planner, perception: moondream2}
"""


def test_users_can_add_entries(tmp_path: Path) -> None:
    file = tmp_path / "models.yaml"
    file.write_text(OWN)
    registry = load_registry(file)
    model = registry.model("my-planner", "planner")
    assert (model.origin, model.title, model.url) == ("yours", "my-planner", "http://gpu:8000/v1")
    assert registry.commands(model, "mine") == ("serve me/planner --json '{\"a\": {}}'",)
    assert "my-planner+moondream2" in registry.pairs
    assert len(registry.models) == len(load_registry().models) + 1


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("models: [", "not valid YAML"),
        ("models: {x: {repo: a}}", "models.x.roles"),
        ("models: 3", "models"),
        ("nonsense: 1", "nonsense"),
        (OWN.replace("bf16", "fp17"), "models.my-planner.precision"),
        (OWN.replace("size_b: 1", "size_b: .nan"), "models.my-planner.size_b"),
        (OWN.replace("active_b: 1", "active_b: 2"), "active_b cannot exceed"),
        (OWN.replace("http://gpu:8000/v1", "gpu"), "URL"),
        (OWN.replace("vllm: {}", "vlm: {}"), "no such server"),
        (OWN.replace("perception: moondream2", "perception: moondream9"), "moondream9"),
        ("pairs: [{planner: x}]", "pairs.0.perception"),
        ("!!python/object/apply:os.system ['true']", "not valid YAML"),
    ],
)
def test_errors_name_the_file_and_the_field(tmp_path: Path, text: str, told: str) -> None:
    file = tmp_path / "models.yaml"
    file.write_text(text)
    with pytest.raises((ConfigError, UnknownNameError), match=told.replace(".", r"\.")):
        load_registry(file)


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be read"):
        load_registry(tmp_path / "none.yaml")

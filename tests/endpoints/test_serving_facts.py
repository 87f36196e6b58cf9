"""Facts that servers report about themselves, each at its own path."""

from __future__ import annotations

import json

import anyio
import pytest

from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.serving_facts import memory_gb, serving_facts
from tests.support.misbehaving import Behaviour, Exchange, Misbehaving, body, huge, slow_first_byte, status

VLLM = {
    "/v1/models": json.dumps({"data": [{"id": "q", "owned_by": "vllm", "max_model_len": 16384}]}),
    "/version": '{"version": "0.33.0"}',
    "/metrics": (
        "# HELP x\n"
        'vllm:cache_config_info{block_size="16",cache_dtype="auto",gpu_memory_utilization="0.9",x="y"} 1.0\n'
        "process_resident_memory_bytes 4.2e+09\n"
    ),
}
OLLAMA = {
    "/api/ps": json.dumps({"models": [{"name": "q", "size_vram": 5_000_000_000, "details": {"quantization_level": "Q4_K_M"}}]})
}
SGLANG = {"/get_server_info": json.dumps({"internal_states": [{"memory_usage": {"weight": 8.5, "kvcache": 2.25}}], "tp_size": 1})}


def serving_pages(places: dict[str, str]) -> Behaviour:
    async def behave(x: Exchange) -> None:
        known = x.request.path in places
        await (body(places[x.request.path], "text/plain") if known else status(404))(x)

    return behave


def facts(behaviour: Behaviour) -> dict[str, str]:
    with Misbehaving(then=behaviour) as server:
        return anyio.run(serving_facts, Endpoint(url=server.url))


def test_vllm() -> None:
    stated = facts(serving_pages(VLLM))
    assert stated["/v1/models max_model_len"] == "16384"
    assert stated["/version version"] == "0.33.0"
    assert stated["/metrics gpu_memory_utilization"] == "0.9"
    assert "/metrics x" not in stated
    assert memory_gb(stated) is None


@pytest.mark.parametrize(("places", "expected"), [(OLLAMA, 5.0), (SGLANG, 10.75)])
def test_memory_is_read_where_it_is_reported(places: dict[str, str], expected: float) -> None:
    assert memory_gb(facts(serving_pages(places))) == expected


@pytest.mark.parametrize("behaviour", [status(500), body("{"), body("[1, 2"), body('{"id": NaN}'), huge()])
def test_a_bad_server_gives_no_facts_and_no_error(behaviour: Behaviour) -> None:
    assert set(facts(behaviour)) <= {
        f"{place} id" for place in ("/v1/models", "/version", "/props", "/api/ps", "/get_server_info", "/v1/stats")
    }


def test_a_silent_server_gives_no_facts(monkeypatch: pytest.MonkeyPatch) -> None:
    from scope_ptz.endpoints import serving_facts as module
    from scope_ptz.endpoints.endpoint import Timeouts

    monkeypatch.setattr(module, "QUICK_TIMEOUTS", Timeouts(connect_s=0.1, first_byte_s=0.05, total_s=0.1))
    assert facts(slow_first_byte()) == {}

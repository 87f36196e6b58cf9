"""Read the configuration that a model server reports, such as its version, context length, precision and memory use."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from scope_ptz.endpoints.bodies import safe_text
from scope_ptz.endpoints.catalogue import QUICK_TIMEOUTS
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import scrub
from scope_ptz.endpoints.translate import as_failure

if TYPE_CHECKING:
    from httpx2 import AsyncClient

PATHS = ("/v1/models", "/version", "/props", "/api/ps", "/get_server_info", "/metrics", "/v1/stats")
"""Paths at which servers report their configuration.

Most servers have the first two. The others are for llama.cpp (props), Ollama (ps), SGLang (server info), vLLM (metrics) and
Moondream Station (stats).
"""
_FIELDS = re.compile(
    r"^(id|owned_by|root|max_model_len|version|build_info|model_path|n_ctx|size|size_vram|context_length|parameter_size"
    r"|quantization(_level)?|dtype|tp_size|tensor_parallel_size|memory_usage|weight|kvcache|kv_cache_dtype|attention_backend"
    r"|gpu_memory_utilization|num_gpu_blocks|block_size|enable_prefix_caching|cache_dtype|status|model|device|workers)$"
)
_METRIC = re.compile(r"^(vllm:cache_config_info\{(?P<labels>.*)\}|process_resident_memory_bytes)\s+(?P<value>\S+)$", re.MULTILINE)
_LABEL = re.compile(r'(\w+)="([^"]*)"')
_MAX_VALUE_CHARS = 200  # longer values are truncated
_MAX_FACTS = 40  # further fields are ignored


async def serving_facts(endpoint: Endpoint) -> dict[str, str]:
    """Return a server's reported configuration, keyed by path and field. Paths that fail are omitted."""
    from scope_ptz.endpoints.transport import make_client

    quick_endpoint = endpoint.model_copy(update={"timeouts": QUICK_TIMEOUTS})
    root = quick_endpoint.url.removesuffix("/v1")
    facts: dict[str, str] = {}
    async with make_client(quick_endpoint) as client:
        for path in PATHS:
            text = await _get(client, root + path, quick_endpoint)
            for name, value in _facts(path, text):
                if len(facts) < _MAX_FACTS:
                    facts[f"{path} {name}"] = safe_text(scrub(value, quick_endpoint.secret))[:_MAX_VALUE_CHARS]
    return facts


async def _get(client: AsyncClient, url: str, endpoint: Endpoint) -> str:
    try:
        response = await client.get(url)
    except Exception as error:
        if as_failure(error, endpoint) is None:
            raise
        return ""
    return response.text if response.is_success else ""


def _facts(path: str, text: str) -> Iterator[tuple[str, str]]:
    if path == "/metrics":
        for match in _METRIC.finditer(text):
            yield from _labels(match["labels"]) if match["labels"] else [("process_resident_memory_bytes", match["value"])]
        return
    try:
        content = json.loads(text)
    except (ValueError, RecursionError):
        return
    yield from _nested_fields(content, depth=0)


def _labels(labels: str) -> Iterator[tuple[str, str]]:
    yield from ((name, value) for name, value in _LABEL.findall(labels) if _FIELDS.match(name))


def _nested_fields(content: Any, depth: int) -> Iterator[tuple[str, str]]:
    """Yield the names and values of the relevant fields in nested JSON, down to a limited depth."""
    if depth > 4:
        return
    if isinstance(content, Mapping):
        for name, value in content.items():
            if isinstance(value, Mapping | list):
                yield from _nested_fields(value, depth + 1)
            elif value is not None and _FIELDS.match(str(name)):
                yield str(name), str(value)
    elif isinstance(content, list):
        for value in content[:5]:
            yield from _nested_fields(value, depth + 1)


def memory_gb(facts: Mapping[str, str]) -> float | None:
    """Return the model's memory use in GB, as reported by Ollama or SGLang; None for other servers."""
    by_name = {key.split(" ", 1)[1]: value for key, value in facts.items()}
    try:
        if "size_vram" in by_name:
            return round(float(by_name["size_vram"]) / 1e9, 2)
        if "weight" in by_name:
            return round(float(by_name["weight"]) + float(by_name.get("kvcache", 0)), 2)
    except ValueError:
        pass
    return None

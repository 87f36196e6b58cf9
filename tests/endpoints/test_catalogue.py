"""Finding a server's models and the base address of its API."""

from __future__ import annotations

import json

import anyio
import pytest

from scope_ptz.endpoints.catalogue import find_api, served_models
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from tests.support.misbehaving import MODEL, Behaviour, Exchange, Misbehaving, body, slow_first_byte, status, wrong_type


def only_under_v1(refusal: Behaviour) -> Behaviour:
    """A server whose API is only under /v1."""

    async def behave(x: Exchange) -> None:
        if x.request.path == "/v1/models":
            await body(json.dumps({"data": [{"id": MODEL}]}))(x)
        else:
            await refusal(x)

    return behave


@pytest.mark.parametrize("refusal", [status(404), wrong_type()])
@pytest.mark.parametrize("path", ["", "/v1", "/v1/"])
def test_the_api_is_found_under_v1(refusal: Behaviour, path: str) -> None:
    with Misbehaving(then=only_under_v1(refusal)) as server:
        endpoint, models = anyio.run(find_api, Endpoint(url=server.root + path))
    assert (endpoint.url, models) == (server.url, (MODEL,))


@pytest.mark.parametrize(
    ("behaviour", "kind"),
    [
        (status(401), FailureKind.UNAUTHORISED),
        (status(404), FailureKind.NOT_FOUND),
        (body('{"data": 3}'), FailureKind.MALFORMED),
        (body("[]"), FailureKind.MALFORMED),
    ],
)
def test_a_missing_model_list_is_a_failure_with_its_kind(behaviour: Behaviour, kind: FailureKind) -> None:
    with Misbehaving(then=behaviour) as server, pytest.raises(ServerFailure) as failure:
        anyio.run(find_api, Endpoint(url=server.root))
    assert failure.value.kind is kind


def test_entries_without_a_name_are_skipped() -> None:
    listing = {"data": [{"id": "a"}, {"id": 3}, "x", {}, {"id": ""}, {"id": "b"}]}
    with Misbehaving(then=body(json.dumps(listing))) as server:
        assert anyio.run(served_models, Endpoint(url=server.url)) == ("a", "b")


def test_the_list_of_models_has_a_short_timeout(monkeypatch: pytest.MonkeyPatch) -> None:
    from scope_ptz.endpoints import catalogue
    from scope_ptz.endpoints.endpoint import Timeouts

    monkeypatch.setattr(catalogue, "QUICK_TIMEOUTS", Timeouts(connect_s=0.2, first_byte_s=0.2, total_s=0.3))
    with Misbehaving(then=slow_first_byte()) as server, pytest.raises(ServerFailure) as failure:
        anyio.run(served_models, Endpoint(url=server.url))
    assert failure.value.kind in (FailureKind.FIRST_BYTE_TIMEOUT, FailureKind.TOTAL_TIMEOUT)

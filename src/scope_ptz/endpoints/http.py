"""A client for model servers with a plain JSON API."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from scope_ptz.endpoints.bodies import read_object
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.failures import Attempt
from scope_ptz.endpoints.retries import Caller
from scope_ptz.endpoints.translate import status_failure

if TYPE_CHECKING:
    from httpx2 import AsyncClient


class JsonClient:
    """A client that posts JSON and returns JSON objects. ``key_header`` is the name of the request header that contains the key."""

    def __init__(self, endpoint: Endpoint, *, key_header: str = "Authorization", caller: Caller | None = None) -> None:
        self.endpoint, self.key_header = endpoint, key_header
        self.caller = caller or Caller(endpoint)
        self._client: AsyncClient | None = None

    async def post(self, path: str, body: bytes | dict[str, Any]) -> tuple[dict[str, Any], tuple[Attempt, ...]]:
        """Post a JSON body, which may already be encoded as bytes. Return the reply and the attempts.

        Raises:
            ServerFailure: The server did not return a usable reply.
        """
        content = body if isinstance(body, bytes) else json.dumps(body, separators=(",", ":"), allow_nan=False).encode()
        if self._client is None:
            from scope_ptz.endpoints.transport import make_client

            self._client = make_client(self.endpoint, key_header=self.key_header)
        client, url = self._client, f"{self.endpoint.url}/{path.lstrip('/')}"
        return await self.caller.call(lambda: self._exchange(client, url, content))

    async def _exchange(self, client: AsyncClient, url: str, content: bytes) -> dict[str, Any]:
        async with client.stream("POST", url, content=content, headers={"content-type": "application/json"}) as response:
            if response.is_success:
                return await read_object(response, self.endpoint)
            await response.aread()
            raise status_failure(response.status_code, response.headers, response.text, self.endpoint)

    async def close(self) -> None:
        """Close the connections. The next request opens new connections."""
        if self._client is not None:
            client, self._client = self._client, None
            await client.aclose()

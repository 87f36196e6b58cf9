"""Access control: digest authentication and account roles."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from ipaddress import ip_address

from starlette.requests import HTTPConnection, Request
from starlette.responses import PlainTextResponse, Response

from scope_ptz.virtual_camera.accounts import Accounts, Role
from scope_ptz.virtual_camera.digest import DigestAuthenticator
from scope_ptz.virtual_camera.vapix.replies import Client

Handler = Callable[[Request, Client], Awaitable[Response]]


class AccessControl:
    """Authenticates and authorizes a camera's clients. Plain-text passwords (Basic) are neither requested nor accepted.

    Args:
        accounts: The accounts that may use the camera.
        realm: The authentication realm, which clients show to their users.
    """

    def __init__(self, accounts: Accounts, realm: str) -> None:
        self._accounts = accounts
        self._digest = DigestAuthenticator(accounts, realm)

    def for_role(self, role: Role, handler: Handler) -> Callable[[Request], Awaitable[Response]]:
        """Return an endpoint that calls a handler for accounts with at least the given role, and rejects others."""

        async def endpoint(request: Request) -> Response:
            client = self._client(request)
            if isinstance(client, Response):
                return client
            if client.role < role:
                return PlainTextResponse("Forbidden\n", 403)
            return await handler(request, client)

        return endpoint

    def refusal(self, *, stale: bool = False) -> Response:
        """Return a 401 reply, which asks the client to authenticate."""
        response = PlainTextResponse("Unauthorized\n", 401)
        for challenge in self._digest.challenges(stale=stale):
            response.headers.append("WWW-Authenticate", challenge)
        return response

    def _client(self, request: Request) -> Client | Response:
        if self._accounts.is_open:
            return Client(client_address(request), Role.ADMINISTRATOR)
        target = request.scope["raw_path"].decode("latin-1")
        if query := request.scope["query_string"].decode("latin-1"):
            target += f"?{query}"
        result = self._digest.check(request.headers.get("authorization"), request.method, target)
        if result.account is None:
            return self.refusal(stale=result.stale)
        return Client(result.account.name, result.account.role)


def client_address(connection: HTTPConnection) -> str:
    """Return a client's address; empty if it is unknown."""
    return connection.client.host if connection.client else ""


def is_local(connection: HTTPConnection) -> bool:
    """Return whether a client is running on this machine."""
    try:
        address = ip_address(client_address(connection))
    except ValueError:
        return False
    mapped = getattr(address, "ipv4_mapped", None)
    return (mapped or address).is_loopback


def is_cross_origin(request: Request) -> bool:
    """Return whether a web page from another site made this request, according to the ``Origin`` header."""
    origin = request.headers.get("origin")
    return origin is not None and origin.partition("://")[2] != request.headers.get("host")

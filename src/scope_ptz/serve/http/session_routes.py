"""Routes for signing in and out, and for information about the server."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from starlette.exceptions import HTTPException

from scope_ptz.serve.http.dependencies import AccessDep, SiteDep, Viewer
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import ClientInfo, ModelHealth, PairHealth, ServerInfo, SignIn
from scope_ptz.serve.security.access import cookie_of
from scope_ptz.serve.security.sessions import COOKIE
from scope_ptz.serve.security.sign_in import is_secure, set_cookie
from scope_ptz.version import __version__

router = APIRouter(tags=["server"])


@router.get("/health", responses=responses())
async def health() -> dict[str, str]:
    """Report that the server is running. This request needs no token."""
    return {"status": "ok"}


@router.get("/server", responses=responses())
async def server(site: SiteDep, client: Viewer) -> ServerInfo:  # noqa: ARG001 - checks the token
    """Return the server's version and the names of its cameras and pairs."""
    return ServerInfo(name="scope-ptz", version=__version__, cameras=list(site.stations), pairs=list(site.pairs.names))


@router.get("/me", responses=responses())
async def me(client: Viewer, access: AccessDep) -> ClientInfo:
    """Return the client's name, role and key."""
    return ClientInfo(name=client.name, role=client.role, client=client.key, signs_in=access.needs_token)


@router.post("/session", status_code=204, responses=responses(409))
async def sign_in(request: Request, access: AccessDep, body: SignIn) -> Response:
    """Sign a browser in with a token. The reply sets a cookie that scripts cannot read."""
    access.limits.count(request.client.host if request.client else "", "sign_in")
    token = access.tokens.find(body.token) if access.tokens is not None else None
    if token is None:
        raise HTTPException(401, "This token is unknown.")
    response = Response(status_code=204)
    set_cookie(response, access.sessions.begin(token), secure=is_secure(request))
    return response


@router.delete("/session", status_code=204, responses=responses())
async def sign_out(request: Request, access: AccessDep) -> Response:
    """Sign a browser out."""
    access.sessions.end(cookie_of({name.lower(): value for name, value in request.headers.items()}))
    response = Response(status_code=204)
    response.delete_cookie(COOKIE, path="/", httponly=True, samesite="strict")
    return response


@router.get("/pairs", responses=responses())
async def pairs(site: SiteDep, client: Viewer) -> list[str]:  # noqa: ARG001 - checks the token
    """List the pairs of models that requests can use. The first pair is the default."""
    return list(site.pairs.names)


@router.get("/pairs/{pair}/health", responses=responses(404))
async def pair_health(site: SiteDep, client: Viewer, pair: str) -> PairHealth:  # noqa: ARG001 - checks the token
    """Return whether the models of a pair can be used."""
    planner, perception = await site.pairs.health(pair)
    return PairHealth(
        pair=pair,
        planner=ModelHealth(name=planner.name, state=planner.state),
        perception=ModelHealth(name=perception.name, state=perception.state),
    )

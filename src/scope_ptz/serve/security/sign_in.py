"""The sign-in page. It works without scripts."""

from __future__ import annotations

from html import escape
from urllib.parse import parse_qs

from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import Route

from scope_ptz.serve.security.access import SIGN_IN_PATH, Access
from scope_ptz.serve.security.sessions import COOKIE, LIFETIME_S
from scope_ptz.serve.site.errors import TooManyRequestsError

# The page's content security policy.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; form-action 'self'; frame-ancestors 'none'; base-uri 'none'"

_PAGE = """<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Sign in to SCOPE</title><style>
:root {{ color-scheme: light dark; --ink: #16202b; --ground: #f5f7f9; --panel: #fff; --edge: #c4ccd6;
  --accent: #0b6ea8; --bad: #b3261e; }}
@media (prefers-color-scheme: dark) {{
  :root {{ --ink: #f2f5f9; --ground: #0e131a; --panel: #18202b; --edge: #3c4a5b; --accent: #4cc3f7; --bad: #ff9b90; }} }}
body {{ margin: 0; min-height: 100vh; display: grid; place-items: center; font: 16px/1.5 system-ui, sans-serif;
  color: var(--ink); background: var(--ground); }}
main {{ width: min(22rem, 88vw); padding: 2rem; border: 1px solid var(--edge); border-radius: 12px; background: var(--panel); }}
h1 {{ margin: 0 0 1rem; font-size: 1.25rem; font-weight: 600; }}
label {{ display: block; margin-bottom: .35rem; }}
input, button {{ width: 100%; box-sizing: border-box; padding: .6rem .75rem; font: inherit; border-radius: 8px; }}
input {{ border: 1px solid var(--edge); color: inherit; background: transparent; }}
button {{ margin-top: 1rem; border: 0; color: var(--panel); background: var(--accent); cursor: pointer; }}
:focus-visible {{ outline: 3px solid var(--accent); outline-offset: 2px; }}
p {{ margin: 0 0 1rem; color: var(--bad); }}
</style></head><body><main><h1>Sign in to SCOPE</h1>{problem}<form method="post" action="{path}">
<label for="token">Your token</label><input id="token" name="token" type="password" autocomplete="current-password"
  required autofocus>
<button type="submit">Sign in</button></form></main></body></html>"""


def sign_in_route(access: Access) -> Route:
    """Return the sign-in page's route. ``AccessMiddleware`` admits requests to this route without a token."""

    async def sign_in(request: Request) -> Response:
        if request.method != "POST":
            return _page("")
        try:
            access.limits.count(request.client.host if request.client else "", "sign_in")
        except TooManyRequestsError as error:
            return _page(str(error), 429)
        fields = parse_qs((await request.body()).decode("utf-8", "replace"), max_num_fields=5)
        token = access.tokens.find(fields.get("token", [""])[0].strip()) if access.tokens is not None else None
        if token is None:
            return _page("This token is unknown. Check that you copied the whole token.", 401)
        response = RedirectResponse("/", 303)
        set_cookie(response, access.sessions.begin(token), secure=is_secure(request))
        return response

    return Route(SIGN_IN_PATH, sign_in, methods=["GET", "POST"])


def set_cookie(response: Response, secret: str, *, secure: bool) -> None:
    """Set the session cookie in a reply. Scripts cannot read it, and pages on other sites cannot make a browser send it."""
    response.set_cookie(COOKIE, secret, max_age=int(LIFETIME_S), path="/", httponly=True, samesite="strict", secure=secure)


def is_secure(request: Request) -> bool:
    """Return whether the browser uses HTTPS, either directly or through a proxy that sets ``X-Forwarded-Proto``.

    A client that sets the header but uses HTTP affects only itself: its browser does not send the cookie back.
    """
    return request.url.scheme == "https" or request.headers.get("x-forwarded-proto") == "https"


def _page(problem: str, status: int = 200) -> Response:
    text = _PAGE.format(problem=f'<p role="alert">{escape(problem)}</p>' if problem else "", path=SIGN_IN_PATH)
    return HTMLResponse(text, status, headers={"Content-Security-Policy": POLICY, "Cache-Control": "no-store"})

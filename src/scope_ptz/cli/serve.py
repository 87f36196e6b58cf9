"""``scope serve``, ``scope console``, ``scope mcp`` and ``scope token``: run the server and manage its tokens."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import AsyncIterator
    from contextlib import AbstractAsyncContextManager

    from scope_ptz.cli.options import ServerFlags
    from scope_ptz.serve.security.access import Access
    from scope_ptz.serve.security.tokens import TokenFile
    from scope_ptz.serve.site.site import Site

SWITCH_INTERVAL_S = 0.001
"""Maximum time in seconds that a thread runs before others get a turn. The default of 5 ms would delay ``stop`` calls."""


ServerKind = Literal["api", "page", "mcp"]
"""What a server offers: "api" (the HTTP API and MCP), "page" (also the operator console), or "mcp" (only MCP)."""

_PACKAGES = ("fastapi", "mcp", "mcp_types", "sqlalchemy", "starlette", "streamlit", "uvicorn", "websockets")


def run_server(flags: ServerFlags, *, kind: ServerKind = "api", as_json: bool) -> None:
    """Serve cameras over HTTP until Ctrl-C."""
    from scope_ptz.cli.exit import put, put_json, run_async
    from scope_ptz.settings import load_settings

    _prepare_process()
    with _explain_missing_package("console" if kind == "page" else "serve"):
        from scope_ptz.serve.security.access import Access
        from scope_ptz.serve.security.origins import is_loopback

        serve_site = _server_function(kind)
    make_site = _site_factory(flags)
    host, names = flags.host, flags.name or []
    needs_tokens = flags.tokens is not None or not is_loopback(host) or bool(names)
    access = Access(host, _read_token_file(flags.tokens or load_settings().tokens) if needs_tokens else None, tuple(names))

    async def work() -> None:
        import anyio

        site = make_site()
        async with serve_site(site, access, flags.port) as bound_port:
            address = f"[{host}]" if ":" in host else host
            url = f"http://{address}:{bound_port}"
            access_note = "with tokens" if needs_tokens else "on this machine only"
            if as_json:
                put_json({"url": url, "cameras": list(site.stations), "pairs": list(site.pairs.names), "tokens": needs_tokens})
            elif kind == "page":
                put(f"Open {url} in a browser ({access_note}). Press Ctrl-C to stop.")
            elif kind == "mcp":
                put(f"Serving {len(site.stations)} cameras to MCP clients at {url}/mcp ({access_note}). Press Ctrl-C to stop.")
            else:
                first_camera = next(iter(site.stations))
                put(f"Serving {len(site.stations)} cameras at {url}/api/v1, and to MCP clients at {url}/mcp ({access_note}).")
                put("")
                put("Try:")
                put(f"  curl {url}/api/v1/cameras")
                put(f"  python -c \"import scope_ptz; print(scope_ptz.open('{url}/{first_camera}').ask('zoom in 2x'))\"")
                put("")
                put("Press Ctrl-C to stop.")
            sys.stdout.flush()
            await (_wait_for_end_of_input() if flags.until_eof else anyio.sleep_forever())

    run_async(work)


def run_mcp(flags: ServerFlags, transport: str, role: str, *, as_json: bool) -> None:
    """Serve cameras to MCP clients, on standard input and output or over HTTP.

    Args:
        flags: The server options. Network options do not apply to standard input and output.
        transport: ``stdio`` or ``http``.
        role: The client's role on standard input and output. Over HTTP, tokens determine the roles.
        as_json: Whether to print the address as JSON.
    """
    if transport not in ("stdio", "http"):
        raise InputError(f"--transport must be stdio or http; got '{transport[:40]}'.")
    if role not in ("viewer", "operator"):
        raise InputError(f"--role must be viewer or operator; got '{role[:40]}'.")
    if transport == "http":
        run_server(flags, kind="mcp", as_json=as_json)
        return
    if as_json:
        raise InputError("--json requires --transport http, because standard output carries protocol messages with stdio.")
    from scope_ptz.cli.exit import run_async
    from scope_ptz.settings import load_settings

    _prepare_process()
    with _explain_missing_package("serve"):
        from scope_ptz.serve.mcp.stdio import serve_stdio
    if sys.stdin.isatty():
        sys.stderr.write("This command speaks MCP on standard input and output. Configure it in an assistant; see docs/mcp.md.\n")
    # Desktop programs may start this command in a folder that is not writable.
    make_site = _site_factory(flags, load_settings().user_runs_folder())
    run_async(lambda: serve_stdio(make_site(), role="operator" if role == "operator" else "viewer"))


def _prepare_process() -> None:
    from scope_ptz.virtual_camera.heap import use_one_heap

    use_one_heap()
    sys.setswitchinterval(SWITCH_INTERVAL_S)


@contextmanager
def _explain_missing_package(extra: str) -> Iterator[None]:
    """Convert the error for a missing package to a message that states how to install the package.

    Raises:
        InputError: A package is missing.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if (package := (error.name or "").split(".")[0]) not in _PACKAGES:
            raise
        raise InputError(
            f"The server requires the package {package}. Install it with: pip install 'scope-ptz[{extra}]'."
        ) from error


def _server_function(kind: ServerKind) -> Callable[[Site, Access, int], AbstractAsyncContextManager[int]]:
    """Return a context manager function that serves a site on a port with access rules, and yields the bound port."""
    if kind == "page":
        from scope_ptz.console.server import serve_console

        return lambda site, access, port: serve_console(site, access, port=port)
    from scope_ptz.serve.server import serve

    if kind == "api":
        return lambda site, access, port: serve(site, access, port=port)
    from scope_ptz.serve.mcp.http import mcp_application, serve_mcp

    @asynccontextmanager
    async def serve_only_mcp(site: Site, access: Access, port: int) -> AsyncIterator[int]:
        async with (
            serve_mcp(site, access) as route,
            serve(site, access, port=port, app=mcp_application(access, route)) as bound_port,
        ):
            yield bound_port

    return serve_only_mcp


def _site_factory(flags: ServerFlags, runs_dir: Path | None = None) -> Callable[[], Site]:
    """Check the options for a site, and return a function that creates it. Call the function in the event loop.

    Args:
        flags: The server options.
        runs_dir: The default runs folder; None to use the folder in the settings.
    """
    from scope_ptz.serve.site.site import Site, SiteOptions, idle_returns, site_cameras
    from scope_ptz.serve.site.station import IdleReturn
    from scope_ptz.settings import load_settings

    settings, cameras = load_settings(), flags.cameras or []
    served_cameras = site_cameras(cameras, settings)
    idle = None if flags.idle_after is None else IdleReturn(flags.idle_after, flags.idle_preset)
    folder, pairs = flags.runs_dir or runs_dir or settings.runs_dir, tuple(flags.pair or ())
    options = SiteOptions(folder, tuple(cameras), pairs, idle=idle, idle_by_camera=idle_returns())
    return lambda: Site(served_cameras, options)


async def _wait_for_end_of_input() -> None:
    """Wait until standard input is closed, which also happens if the program that started the server crashes."""
    import asyncio
    import os
    import threading
    from contextlib import suppress

    ended, loop = asyncio.Event(), asyncio.get_running_loop()

    def read() -> None:
        with suppress(OSError):
            while os.read(0, 4096):
                pass
        with suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(ended.set)

    threading.Thread(target=read, name="end-of-input", daemon=True).start()
    await ended.wait()


def add_token(name: str, role: str, tokens: Path | None, *, as_json: bool) -> None:
    """Create and print a token."""
    from scope_ptz.cli.exit import put, put_json

    if role not in ("viewer", "operator"):
        raise InputError(f"--role must be viewer or operator; got '{role[:40]}'.")
    file = _token_file(tokens)
    secret = file.add(name, "operator" if role == "operator" else "viewer")
    if as_json:
        put_json({"name": name, "role": role, "token": secret, "file": str(file.path)})
    else:
        put(secret)
        sys.stderr.write(f"This is the token of {name} ({role}). It cannot be shown again: {file.path} stores only its hash.\n")


def list_tokens(tokens: Path | None, *, as_json: bool) -> None:
    """Print the names and roles of tokens."""
    from scope_ptz.cli.exit import put, put_json

    entries = _token_file(tokens).tokens
    if as_json:
        put_json([{"name": token.name, "role": token.role, "created": token.created.isoformat()} for token in entries])
        return
    for token in entries:
        put(f"{token.name:<30} {token.role:<9} {token.created:%Y-%m-%d}")
    if not entries:
        put("No tokens. Create one with `scope token add NAME --role operator`.")


def remove_token(name: str, tokens: Path | None) -> None:
    """Remove a token. A running server rejects it from the next request onwards."""
    _token_file(tokens).remove(name)


def _token_file(tokens: Path | None) -> TokenFile:
    from scope_ptz.settings import load_settings

    return _read_token_file(tokens or load_settings().tokens)


def _read_token_file(path: Path) -> TokenFile:
    from scope_ptz.serve.security.tokens import TokenFile

    return TokenFile(path)

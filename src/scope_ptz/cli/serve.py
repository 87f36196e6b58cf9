"""``scope serve``, ``scope console`` and ``scope token``: run the server and manage its tokens."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from scope_ptz.cli.options import ServerFlags
    from scope_ptz.serve.security.tokens import TokenFile

SWITCH_INTERVAL_S = 0.001
"""Seconds for which a thread may run before others get a turn. With the default of 5 ms, rendering would delay a ``stop``."""


def run_server(flags: ServerFlags, *, page: bool = False, as_json: bool) -> None:
    """Serve cameras until Ctrl-C. If ``page`` is set, serve the operator's page as well."""
    from scope_ptz.cli.exit import put, put_json, run_async
    from scope_ptz.settings import load_settings
    from scope_ptz.virtual_camera.heap import use_one_heap

    use_one_heap()
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    try:
        from scope_ptz.serve.security.gate import Access
        from scope_ptz.serve.security.origins import is_loopback
        from scope_ptz.serve.server import serve
        from scope_ptz.serve.site.service import Site, SiteOptions, idle_returns, site_cameras
        from scope_ptz.serve.site.station import IdleReturn

        if page:
            from scope_ptz.console.server import serve_console as serving
        else:
            serving = serve
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in ("fastapi", "sqlalchemy", "starlette", "streamlit", "uvicorn", "websockets"):
            raise
        raise InputError(
            f"The server needs {error.name}. Install it with: pip install 'scope-ptz[{'console' if page else 'serve'}]'."
        ) from error
    settings = load_settings()
    host, cameras, names = flags.host, flags.cameras or [], flags.name or []
    needed = flags.tokens is not None or not is_loopback(host) or bool(names)
    access = Access(host, _tokens(flags.tokens or settings.tokens) if needed else None, tuple(names))
    chosen = site_cameras(cameras, settings)
    idle = None if flags.idle_after is None else IdleReturn(flags.idle_after, flags.idle_preset)
    runs_dir, pairs = flags.runs_dir or settings.runs_dir, tuple(flags.pair or ())
    options = SiteOptions(runs_dir, tuple(cameras), pairs, idle=idle, idle_of=idle_returns())

    async def work() -> None:
        import anyio

        site = Site(chosen, options)
        async with serving(site, access, port=flags.port) as bound:
            shown = f"[{host}]" if ":" in host else host
            url = f"http://{shown}:{bound}"
            if as_json:
                put_json({"url": url, "cameras": list(site.stations), "pairs": list(site.pairs.names), "tokens": needed})
            elif page:
                put(f"Open {url} in a browser ({'with tokens' if needed else 'on this machine only'}). Press Ctrl-C to stop.")
            else:
                first = next(iter(site.stations))
                put(
                    f"Serving {len(site.stations)} cameras at {url}/api/v1 ({'with tokens' if needed else 'on this machine only'})."
                )
                put("")
                put("Try:")
                put(f"  curl {url}/api/v1/cameras")
                put(f"  python -c \"import scope_ptz; print(scope_ptz.open('{url}/{first}').ask('zoom in 2x'))\"")
                put("")
                put("Press Ctrl-C to stop.")
            sys.stdout.flush()
            await (_end_of_input() if flags.until_eof else anyio.sleep_forever())

    run_async(work)


async def _end_of_input() -> None:
    """Wait until the standard input is closed, which also happens when the program that started the server crashes."""
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
    """Create a token and print it."""
    from scope_ptz.cli.exit import put, put_json

    if role not in ("viewer", "operator"):
        raise InputError(f"--role must be viewer or operator; got '{role[:40]}'.")
    file = _file(tokens)
    secret = file.add(name, "operator" if role == "operator" else "viewer")
    if as_json:
        put_json({"name": name, "role": role, "token": secret, "file": str(file.path)})
    else:
        put(secret)
        sys.stderr.write(f"This is the token of {name} ({role}). It cannot be shown again: {file.path} stores only its hash.\n")


def list_tokens(tokens: Path | None, *, as_json: bool) -> None:
    """Print the names and roles of tokens."""
    from scope_ptz.cli.exit import put, put_json

    entries = _file(tokens).tokens
    if as_json:
        put_json([{"name": each.name, "role": each.role, "created": each.created.isoformat()} for each in entries])
        return
    for each in entries:
        put(f"{each.name:<30} {each.role:<9} {each.created:%Y-%m-%d}")
    if not entries:
        put("No tokens. Create one with `scope token add NAME --role operator`.")


def remove_token(name: str, tokens: Path | None) -> None:
    """Remove a token. A running server rejects it from the next request onwards."""
    _file(tokens).remove(name)


def _file(tokens: Path | None) -> TokenFile:
    from scope_ptz.settings import load_settings

    return _tokens(tokens or load_settings().tokens)


def _tokens(path: Path) -> TokenFile:
    from scope_ptz.serve.security.tokens import TokenFile

    return TokenFile(path)

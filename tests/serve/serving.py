"""A server in a separate thread, on a port that the system chooses."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import anyio
import httpx2

from scope_ptz.serve.security.access import Access
from scope_ptz.serve.server import serve
from scope_ptz.serve.site.site import Site, SiteOptions

CAMERA = "yard"
OTHER = "yard-2"


@dataclass(frozen=True)
class Served:
    """A running server: its port, its site, its access rules, and a function that runs functions in its event loop."""

    port: int
    site: Site
    access: Access
    call: Callable[..., Any]

    @property
    def root(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def url(self) -> str:
        return f"{self.root}/api/v1"

    def client(self, token: str | None = None, tab: str = "one") -> httpx2.Client:
        """Return an HTTP client of the API. The server treats each ``tab`` as a separate client."""
        headers = {"Scope-Client": tab} | ({"Authorization": f"Bearer {token}"} if token else {})
        return httpx2.Client(base_url=self.url, headers=headers, timeout=60.0, trust_env=False)


@contextmanager
def serving(options: SiteOptions, access: Access, cameras: dict[str, str]) -> Iterator[Served]:
    """Serve cameras while the context is open."""
    ready: Future[Served] = Future()
    stop: list[Callable[[], None]] = []

    async def run() -> None:
        done = anyio.Event()
        async with anyio.from_thread.BlockingPortal() as portal:
            site = Site(cameras, options)
            async with serve(site, access, port=0) as port:
                stop.append(lambda: portal.call(done.set))
                ready.set_result(Served(port, site, access, portal.call))
                await done.wait()

    def work() -> None:
        try:
            anyio.run(run)
        except BaseException as error:
            if not ready.done():
                ready.set_exception(error)
            raise

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    try:
        yield ready.result(60)
    finally:
        if stop:
            stop[0]()
        thread.join(30)
        assert not thread.is_alive(), "the server did not end"

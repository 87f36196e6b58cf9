"""Run the console under load: a browser, seven stream clients and three conversations on three cameras, on two processor cores.

    python benchmarks/console_load.py [--seconds 600] [--scene highway-works ...] [--no-browser] [--json FILE]

The console runs in a separate process. Four clients watch by WebSocket and three by Motion JPEG. Chromium shows the page and
clicks its stop button. Each conversation gives one instruction after another and follows the events of each run. Two more clients
interfere: one sends ``stop``, which any operator may do; the other tries to move cameras that a conversation controls, which must
always fail. At the end, the store must contain every run as the clients saw it.

The benchmark measures the frames per second of each viewer (target: at least 10), the time until ``stop`` is answered (target:
below 200 ms, or 100 ms for the button in the page), memory over time, and the sockets that are still open after all clients have
disconnected. On a busy machine, clients and server wait for processor time. The wake-up delay of a sleeping thread shows how long.
"""

from __future__ import annotations

import argparse
import asyncio
import itertools
import json
import math
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import httpx2
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

SCENES = ("highway-works", "high-street", "station-square")
VIEWERS = (("socket", 0), ("socket", 1), ("socket", 2), ("socket", 0), ("mjpeg", 0), ("mjpeg", 1), ("mjpeg", 2))
"""Type of each stream client, and the index of its camera."""

TARGET_FRAMES_PER_S, TARGET_STOP_S, TARGET_BUTTON_S = 10.0, 0.2, 0.1
SAMPLE_S = 2.0  # time between two samples of the server's resources
STOP_EVERY_S = 3.0
MOVE_EVERY_S = 2.0
START_S = 15.0
"""Maximum time in seconds at the start that is not counted. In this time, the server reads scenes and Chromium starts."""

CLOSE_S = 20.0  # maximum time until connections of disconnected clients are closed
INSTRUCTIONS = (
    "count the cones",
    "pan right by 25 degrees",
    "how many people are there?",
    "zoom in 2x",
    "count the cars",
    "tilt down by 5 degrees",
    "scan the scene for people",
    "go home",
)
CHROMIUM = "/usr/bin/chromium"
CHROMIUM_ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
WATCH_PAGE = """
window.scope = { drawn: [], stops: [] };
const parse = JSON.parse;
let facts = null, clicked = 0;
JSON.parse = function (...given) {
  const value = parse.apply(this, given);
  if (value && value.taken && value.pose) facts = value;
  return value;
};
const draw = CanvasRenderingContext2D.prototype.drawImage;
CanvasRenderingContext2D.prototype.drawImage = function (...given) {
  draw.apply(this, given);
  if (!this.canvas.classList.contains("picture") || !facts) return;
  const now = performance.timeOrigin + performance.now();
  window.scope.drawn.push([now / 1000, now / 1000 - facts.taken, facts.number]);
};
addEventListener("click", () => { clicked = performance.now(); }, true);
const ask = window.fetch;
window.fetch = async function (...given) {
  const reply = await ask.apply(this, given);
  if (String(given[0]).endsWith("/stop")) window.scope.stops.push([(performance.now() - clicked) / 1000, reply.status]);
  return reply;
};
"""
"""A script that records in the page when each frame was drawn and its age, and the time from a click to the reply to ``stop``."""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=600.0, help="duration of the run in seconds (default: 600)")
    parser.add_argument("--scene", nargs=3, default=SCENES, help="three scenes to serve as cameras")
    parser.add_argument("--no-browser", action="store_true", help="run without Chromium")
    parser.add_argument("--json", type=Path, help="also write the results to this file")
    options = parser.parse_args()
    use_two_cores()
    for scene in options.scene:
        asyncio.run(read_scene(scene))
    with tempfile.TemporaryDirectory() as folder:
        results = Load(tuple(options.scene), Path(folder), with_browser=not options.no_browser).run(options.seconds)
    if options.json is not None:
        options.json.write_text(json.dumps(results, indent=1))
    report(results)
    return 0


async def read_scene(name: str) -> None:
    """Decode all pictures of a scene to the cache on disk, so that the run does not measure decoding."""
    from scope_ptz.camera.simulated import SimulatedCamera
    from scope_ptz.factory.cameras import open_camera

    async with await open_camera(f"sim:{name}") as opened:
        assert isinstance(opened.camera, SimulatedCamera)
        opened.camera.prefetch().wait(600)


def use_two_cores() -> None:
    """Restrict this process and its child processes to two processor cores."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])


# The server, in a separate process ---------------------------------------------------------------------------------------


class Console:
    """A console in a separate process.

    Args:
        cameras: The names of the cameras that it serves.
        runs: The runs folder.
    """

    def __init__(self, cameras: tuple[str, ...], runs: Path) -> None:
        names = itertools.chain.from_iterable(("--camera", name) for name in cameras)
        command = [sys.executable, "-m", "scope_ptz.cli", "console", "--port", "0", "--json", *names, "--runs-dir", str(runs)]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise SystemExit("The console did not start. Its error message is printed above.")
        self.root: str = json.loads(line)["url"]
        self.url = f"{self.root}/api/v1"
        self._folder = Path(f"/proc/{self._process.pid}")

    def sample(self) -> dict[str, float]:
        """Return the memory, threads, TCP sockets and processor time of the process."""
        status = dict(line.split(":", 1) for line in (self._folder / "status").read_text().splitlines())
        times = (self._folder / "stat").read_text().rpartition(")")[2].split()
        tables = [(self._folder / "net" / name).read_text().splitlines()[1:] for name in ("tcp", "tcp6")]
        tcp = {f"socket:[{line.split()[9]}]" for table in tables for line in table}
        sockets = 0
        for each in (self._folder / "fd").iterdir():
            with suppress(OSError):
                sockets += str(each.readlink()) in tcp
        return {
            "memory_mb": int(status["VmRSS"].split()[0]) * 1024 / 1e6,
            "anonymous_mb": int(status["RssAnon"].split()[0]) * 1024 / 1e6,
            "threads": int(status["Threads"]),
            "sockets": sockets,
            "cpu_s": (int(times[11]) + int(times[12])) / os.sysconf("SC_CLK_TCK"),
        }

    def end(self) -> int:
        """Interrupt the process and return its exit code."""
        self._process.send_signal(signal.SIGINT)
        try:
            return self._process.wait(180)  # on a busy disk, unmapping files takes long
        finally:
            if self._process.poll() is None:
                self._process.kill()
            assert self._process.stdout is not None
            self._process.stdout.close()


class Pauses:
    """Measures how late a sleeping thread wakes up. Long delays mean that the machine is busy."""

    STEP_S = 0.02  # duration of each sleep

    def __init__(self) -> None:
        self.late_s: list[float] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        while not self._ended.is_set():
            before_s = time.monotonic()
            time.sleep(self.STEP_S)
            self.late_s.append(time.monotonic() - before_s - self.STEP_S)

    def end(self) -> list[float]:
        """Stop the thread and return its wake-up delays in seconds."""
        self._ended.set()
        self._thread.join()
        return self.late_s


# Clients -----------------------------------------------------------------------------------------------------------------


@dataclass
class Viewer:
    """The frames that a viewer has received.

    Attributes:
        name: The name of the viewer.
        arrivals_s: The arrival times of the frames, in seconds since 1970.
        ages_s: The ages of the frames at arrival, in seconds since their exposure; empty if the stream does not state them.
        out_of_order: The number of frames that were not newer than the frame before.
        failure: The error that ended the viewer early; empty if there was none.
    """

    name: str
    arrivals_s: list[float] = field(default_factory=list)
    ages_s: list[float] = field(default_factory=list)
    out_of_order: int = 0
    failure: str = ""

    def results(self, start_s: float, end_s: float) -> dict[str, Any]:
        """Return statistics of an interval."""
        inside = [at for at in self.arrivals_s if start_s <= at < end_s]
        windows = range(int(start_s), int(end_s) - 10, 10)
        earlier = len(self.ages_s) - len(inside)
        return {
            "frames_per_s": len(inside) / (end_s - start_s),
            "worst_10_s_frames_per_s": min((sum(k <= at < k + 10 for at in inside) / 10 for k in windows), default=None),
            "longest_gap_s": max((b - a for a, b in itertools.pairwise(inside)), default=None),
            "age_s": quantiles(self.ages_s[max(0, earlier) :]) if self.ages_s else None,
            "out_of_order": self.out_of_order,
            "failure": self.failure,
        }


@dataclass
class Observations:
    """The observations of the clients.

    Attributes:
        runs: For each run, the number of tool calls and the outcome that its events reported.
        stops_s: The times in seconds until ``stop`` requests were answered.
        intruders: For each status code, the number of replies to moves of a client that is not in control.
        problems: Unexpected replies and errors.
    """

    runs: dict[str, tuple[int, str]] = field(default_factory=dict)
    stops_s: list[float] = field(default_factory=list)
    intruders: dict[int, int] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)


async def watch_socket(viewer: Viewer, url: str, ended: asyncio.Event) -> None:
    """Watch by WebSocket, without decoding the pictures."""
    last = 0
    async with connect(f"{url.replace('http', 'ws', 1)}/live?width=1280", proxy=None, max_size=2**24) as socket:
        while not ended.is_set():
            message = await asyncio.wait_for(socket.recv(), 120)
            if isinstance(message, str):
                continue
            facts = json.loads(message[4 : 4 + int.from_bytes(message[:4], "big")])
            viewer.arrivals_s.append(time.time())
            viewer.ages_s.append(time.time() - facts["taken"])
            viewer.out_of_order += facts["number"] <= last
            last = facts["number"]
            await socket.send("drawn")


async def watch_mjpeg(viewer: Viewer, url: str, ended: asyncio.Event) -> None:
    """Watch by Motion JPEG, without decoding the pictures."""
    async with httpx2.AsyncClient(trust_env=False, timeout=120) as client, client.stream("GET", f"{url}/live.mjpeg") as reply:
        async for _ in parts(reply.aiter_raw()):
            viewer.arrivals_s.append(time.time())
            if ended.is_set():
                return


async def parts(chunks: AsyncIterator[bytes]) -> AsyncIterator[int]:
    """Yield the size of each part of a multipart stream once it is complete."""
    buffer = bytearray()
    async for chunk in chunks:
        buffer += chunk
        while (head := buffer.find(b"\r\n\r\n")) >= 0:
            length = next(int(line[16:]) for line in buffer[:head].split(b"\r\n") if line.lower().startswith(b"content-length:"))
            if len(buffer) < head + 4 + length + 2:
                break
            del buffer[: head + 4 + length + 2]
            yield length


async def converse(seen: Observations, url: str, camera: str, ended: asyncio.Event) -> None:
    """Give one instruction after another, and follow each run to its end."""
    async with httpx2.AsyncClient(base_url=url, headers={"Scope-Client": f"talk-{camera}"}, trust_env=False, timeout=120) as client:
        conversation = (await client.post("/conversations", json={"camera": camera})).json()["id"]
        for instruction in itertools.cycle(INSTRUCTIONS):
            if ended.is_set():
                return
            body = {"camera": camera, "instruction": instruction, "conversation": conversation}
            reply = await client.post("/runs", json=body)
            if reply.status_code == 409 and reply.json()["error"]["code"] == "stopped":
                continue
            if reply.status_code != 202:
                seen.problems.append(f"{camera}: {instruction}: {reply.status_code} {reply.text[:200]}")
                await asyncio.sleep(1.0)
                continue
            run = reply.json()["id"]
            seen.runs[run] = await follow(client, run)
            await asyncio.sleep(0.5)


async def follow(client: httpx2.AsyncClient, run: str) -> tuple[int, str]:
    """Follow the events of a run, and return the number of its tool calls and its outcome."""
    calls, outcome, name = 0, "", ""
    async with client.stream("GET", f"/runs/{run}/events") as events:
        async for line in events.aiter_lines():
            if line.startswith("event: "):
                name = line[7:]
                calls += name == "call"
            elif line.startswith("data: ") and name == "end":
                outcome = json.loads(line[6:])["outcome"]
    return calls, outcome


async def stop_often(seen: Observations, url: str, cameras: tuple[str, ...], ended: asyncio.Event) -> None:
    """Stop one camera after another, regardless of who controls it."""
    async with httpx2.AsyncClient(base_url=url, headers={"Scope-Client": "stopper"}, trust_env=False, timeout=30) as client:
        for camera in itertools.cycle(cameras):
            began_s = time.perf_counter()
            reply = await client.post(f"/cameras/{camera}/stop")
            seen.stops_s.append(time.perf_counter() - began_s)
            if reply.status_code != 204:
                seen.problems.append(f"stop: {reply.status_code} {reply.text[:200]}")
            if await wait_for_end(ended, STOP_EVERY_S):
                return


async def intrude(seen: Observations, url: str, cameras: tuple[str, ...], ended: asyncio.Event) -> None:
    """Try to move cameras that a conversation controls."""
    async with httpx2.AsyncClient(base_url=url, headers={"Scope-Client": "intruder"}, trust_env=False, timeout=30) as client:
        for camera in itertools.cycle(cameras):
            if await wait_for_end(ended, MOVE_EVERY_S):
                return
            if (await client.get(f"/cameras/{camera}/control")).json()["holder"] is None:
                continue  # its conversation has not begun
            status = (await client.post(f"/cameras/{camera}/move", json={"pan_deg": 90.0})).status_code
            seen.intruders[status] = seen.intruders.get(status, 0) + 1


async def wait_for_end(ended: asyncio.Event, seconds: float) -> bool:
    """Wait for a number of seconds or until ``ended`` is set, and return whether it is set."""
    with suppress(TimeoutError):
        await asyncio.wait_for(ended.wait(), seconds)
    return ended.is_set()


# The browser -------------------------------------------------------------------------------------------------------------


@contextmanager
def chromium() -> Iterator[Browser]:
    """Return a context with a running Chromium."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(CHROMIUM_ARGUMENTS))
        try:
            yield browser
        finally:
            browser.close()


def open_page(browser: Browser, console: Console, camera: str) -> Page:
    """Open the console's page and select a camera."""
    page = browser.new_page(viewport={"width": 1280, "height": 720})
    page.set_default_timeout(30_000)
    page.add_init_script(WATCH_PAGE)
    page.goto(console.root)
    page.wait_for_selector(".stage[data-fps]")
    page.select_option("select.camera", camera)
    return page


def read_page(page: Page) -> dict[str, list[list[float]]]:
    """Return the records of ``WATCH_PAGE`` since the last call."""
    records: dict[str, list[list[float]]] = page.evaluate(
        "(() => { const s = window.scope; window.scope = { drawn: [], stops: [] }; return s; })()"
    )
    return records


# The run -----------------------------------------------------------------------------------------------------------------


class Load:
    """A run of the benchmark: the server, its clients, and the results.

    Args:
        cameras: The names of the three cameras.
        folder: An empty folder for the runs folder.
        with_browser: Whether to run Chromium.
    """

    def __init__(self, cameras: tuple[str, ...], folder: Path, *, with_browser: bool) -> None:
        self._cameras, self._folder, self._with_browser = cameras, folder, with_browser
        self._viewers = [Viewer(f"{kind} {k + 1}: {cameras[number]}") for k, (kind, number) in enumerate(VIEWERS)]
        self._browser = Viewer(f"Chromium: {cameras[0]}")
        self._buttons: list[list[float]] = []
        self._seen = Observations()
        self._samples: list[tuple[float, dict[str, float]]] = []

    def run(self, seconds: float) -> dict[str, Any]:
        """Run the clients for a number of seconds and return the results."""
        console = Console(self._cameras, self._folder / "runs")
        before = console.sample()
        loop, ended, pauses = asyncio.new_event_loop(), asyncio.Event(), Pauses()
        clients = threading.Thread(target=lambda: loop.run_until_complete(self._clients(console, ended)))
        clients.start()
        start_s = time.time()
        try:
            if self._with_browser:
                with chromium() as browser:
                    self._wait(console, start_s + seconds, open_page(browser, console, self._cameras[0]))
            else:
                self._wait(console, start_s + seconds, None)
        finally:
            end_s = time.time()
            loop.call_soon_threadsafe(ended.set)
            clients.join(120)
        late_s = pauses.end()
        deadline_s = time.monotonic() + CLOSE_S
        while (after := console.sample())["sockets"] > before["sockets"] and time.monotonic() < deadline_s:
            time.sleep(0.2)
        stored = self._stored(console)
        code = console.end()
        counted_s = start_s + min(START_S, seconds / 3)
        return {**self._figures(counted_s, end_s), "pauses_s": quantiles(late_s), "exit_code": code, **stored,
                "left_over": {"sockets": after["sockets"] - before["sockets"]}}  # fmt: skip

    async def _clients(self, console: Console, ended: asyncio.Event) -> None:
        url, cameras, seen = console.url, self._cameras, self._seen
        work = [converse(seen, url, camera, ended) for camera in cameras]
        work += [stop_often(seen, url, cameras, ended), intrude(seen, url, cameras, ended)]
        for viewer, (kind, number) in zip(self._viewers, VIEWERS, strict=True):
            watch = watch_socket if kind == "socket" else watch_mjpeg
            work.append(self._watched(viewer, watch(viewer, f"{url}/cameras/{cameras[number]}", ended)))
        for failure in await asyncio.gather(*work, return_exceptions=True):
            if isinstance(failure, BaseException):
                seen.problems.append(f"{type(failure).__name__}: {failure}")

    async def _watched(self, viewer: Viewer, work: Any) -> None:
        try:
            await work
        except (OSError, httpx2.HTTPError, ConnectionClosed, TimeoutError) as error:
            viewer.failure = f"{type(error).__name__}: {error}"

    def _wait(self, console: Console, end_s: float, page: Page | None) -> None:
        first_s = time.time()
        while time.time() < end_s:
            self._samples.append((time.time(), console.sample()))
            if len(self._samples) % 15 == 1:
                now_s, figures = self._samples[-1]
                memory = f"memory {figures['memory_mb']:.0f} MB, of which {figures['anonymous_mb']:.0f} anonymous"
                print(
                    f"{now_s - first_s:5.0f} s  {memory}  {figures['threads']:.0f} threads  {figures['sockets']:.0f} sockets",
                    flush=True,
                )
            if page is None:
                time.sleep(SAMPLE_S)
                continue
            page.wait_for_timeout(SAMPLE_S * 1000)
            page.locator(".stop").click()
            noted = read_page(page)
            self._buttons += noted["stops"]
            self._browser.arrivals_s += [at for at, _, _ in noted["drawn"]]
            self._browser.ages_s += [age for _, age, _ in noted["drawn"]]
            numbers = [number for _, _, number in noted["drawn"]]
            self._browser.out_of_order += sum(b <= a for a, b in itertools.pairwise(numbers))

    def _stored(self, console: Console) -> dict[str, Any]:
        """Compare the stored runs with the observations of the clients, and record differences as problems."""
        outcomes: dict[str, int] = {}
        with httpx2.Client(base_url=console.url, trust_env=False, timeout=60) as client:
            for run, (calls, outcome) in self._seen.runs.items():
                stored = client.get(f"/runs/{run}/details").json()
                if (stored["run"]["outcome"], len(stored["steps"])) != (outcome, calls):
                    self._seen.problems.append(f"{run}: {outcome}, {calls} calls seen; stored: {stored['run']}")
                outcomes[outcome] = outcomes.get(outcome, 0) + 1
        return {"runs": outcomes, "problems": self._seen.problems, "intruders": self._seen.intruders}

    def _figures(self, counted_s: float, end_s: float) -> dict[str, Any]:
        viewers = [*self._viewers, *([self._browser] if self._with_browser else [])]
        counted = [(at, figures) for at, figures in self._samples if at >= counted_s] or self._samples[-1:]
        memory = [figures["anonymous_mb"] for _, figures in counted]  # other memory is mapped files, which the kernel can drop
        third = max(1, len(memory) // 3)
        (first_s, first), (last_s, last) = counted[0], counted[-1]
        return {
            "counted_seconds": end_s - counted_s,
            "viewers": {each.name: each.results(counted_s, end_s) for each in viewers},
            "stop_s": quantiles(self._seen.stops_s),
            "button_s": quantiles([seconds for seconds, _ in self._buttons]) if self._buttons else None,
            "button_statuses": sorted({int(status) for _, status in self._buttons}),
            "memory_mb": {
                "start": statistics.median(memory[:third]),
                "end": statistics.median(memory[-third:]),
                "most": max(memory),
                "with_files": last["memory_mb"],
            },
            "memory_growth": statistics.median(memory[-third:]) / statistics.median(memory[:third]),
            "threads": {"start": first["threads"], "most": max(each["threads"] for _, each in counted)},
            "cores_used": (last["cpu_s"] - first["cpu_s"]) / max(1e-9, last_s - first_s),
            "load": [round(each, 1) for each in os.getloadavg()],
        }


def quantiles(values: list[float]) -> dict[str, float]:
    """Return the median, the 95th percentile, the maximum and the count of a list of values."""
    ordered = sorted(values)
    return {
        "median": statistics.median(ordered),
        "p95": ordered[math.ceil(0.95 * len(ordered)) - 1],
        "most": ordered[-1],
        "count": len(ordered),
    }


def report(results: dict[str, Any]) -> None:
    """Print the results."""
    print(f"\nCounted: {results['counted_seconds']:.0f} s")
    for name, viewer in results["viewers"].items():
        rate, worst, age = viewer["frames_per_s"], viewer["worst_10_s_frames_per_s"], viewer["age_s"]
        figures = [f"{rate:.1f} frames/s ({rate / TARGET_FRAMES_PER_S:.2f} times the target of {TARGET_FRAMES_PER_S:g})"]
        if worst is not None:
            figures.append(f"worst 10 s {worst:.1f}")
        if viewer["longest_gap_s"] is not None:
            figures.append(f"longest gap {1000 * viewer['longest_gap_s']:.0f} ms")
        if age is not None:
            figures.append(f"age {in_ms(age)}")
        print(f"{name}: {'; '.join(figures)} {viewer['failure']}".rstrip())
    print(f"stop, by HTTP: {in_ms(results['stop_s'])}; the target is {1000 * TARGET_STOP_S:.0f} ms")
    if results["button_s"] is not None:
        print(f"stop, from the click in the page: {in_ms(results['button_s'])}; the target is {1000 * TARGET_BUTTON_S:.0f} ms")
    memory, growth, threads = results["memory_mb"], results["memory_growth"], results["threads"]
    parts = f"{memory['start']:.0f} MB, later {memory['end']:.0f} MB: {growth:.3f} x; at most {memory['most']:.0f} MB"
    print(f"Memory: {parts}; with mapped files {memory['with_files']:.0f} MB")
    cores = f"{results['cores_used']:.2f} cores"
    print(f"Processor time of the server: {cores}; threads: {threads['start']:.0f}, at most {threads['most']:.0f}")
    print(f"Wake-up delay of a sleeping thread: {in_ms(results['pauses_s'])}; load of the machine: {results['load']}")
    print(f"Runs by outcome: {results['runs']}; replies to moves without control: {results['intruders']}")
    print(f"Leaked sockets: {results['left_over']['sockets']:.0f}; exit code {results['exit_code']}")
    print(f"Problems: {results['problems'] or 'none'}")


def in_ms(figures: dict[str, float]) -> str:
    """Format quantiles in milliseconds."""
    median, p95, maximum = (f"{1000 * figures[name]:.0f} ms" for name in ("median", "p95", "most"))
    return f"median {median}, 95th percentile {p95}, maximum {maximum}"


if __name__ == "__main__":
    sys.exit(main())

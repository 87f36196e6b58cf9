"""Measure the time and memory of short commands, relative to ``python -c "import numpy, cv2, pydantic"``.

    python benchmarks/startup.py [--rounds N]

The reference and the commands take turns, so that a busy machine slows all of them alike. The benchmark prints the medians of
processor time and wall time as multiples of the reference's, the largest memory, and the targets, which apply to processor time and
memory. The first run of each command is not measured, because it compiles bytecode and fills caches.
"""

from __future__ import annotations

import argparse
import os
import shlex
import statistics
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

REFERENCE = "import numpy, cv2, pydantic"


class Command(NamedTuple):
    """A command with its targets: processor time in multiples of the reference's, and memory."""

    words: list[str]
    ratio: float
    memory_mb: float | None = None


COMMANDS = (
    Command(["--help"], 1.2),
    Command(["tools"], 1.2),
    Command(["plan", "pan right 20, then tilt down 10"], 1.7),
    Command(["ask", "pan right 5"], 5.0, 350.0),
)


class Cost(NamedTuple):
    """Time and peak memory of one process."""

    cpu_s: float
    wall_s: float
    memory_mb: float


def cost(command: list[str], folder: str) -> Cost:
    """Run a command in ``folder`` and return its cost. Exits with a message if the command fails."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, cwd=folder, env=environment)
    assert process.stderr is not None
    errors = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"{' '.join(command)} failed: {errors.decode()}")
    unit = 1 if sys.platform == "darwin" else 1024
    return Cost(usage.ru_utime + usage.ru_stime, time.perf_counter() - start, usage.ru_maxrss * unit / 1e6)


def main() -> None:
    """Run the reference and all commands, and print their costs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7, help="number of runs of each command (default: 7)")
    rounds = parser.parse_args().rounds
    reference = [sys.executable, "-c", REFERENCE]
    programs = [[sys.executable, "-m", "scope_ptz.cli", *command.words] for command in COMMANDS]
    base: list[Cost] = []
    costs: list[list[Cost]] = [[] for _ in COMMANDS]
    with tempfile.TemporaryDirectory() as folder:
        for program in (reference, *programs):
            cost(program, folder)
        for _ in range(rounds):
            base.append(cost(reference, folder))
            for program, runs in zip(programs, costs, strict=True):
                runs.append(cost(program, folder))
    cpu_s, wall_s, memory_mb = summary(base)
    print(f'reference: {cpu_s:.2f} s of processor time, {wall_s:.2f} s, {memory_mb:.0f} MB (python -c "{REFERENCE}")')
    met = True
    for command, runs in zip(COMMANDS, costs, strict=True):
        own = summary(runs)
        ratio = own.cpu_s / cpu_s
        target = f"{command.ratio:g} x" + (f", {command.memory_mb:g} MB" if command.memory_mb else "")
        met = met and ratio <= command.ratio and own.memory_mb <= (command.memory_mb or own.memory_mb)
        line = f"scope {shlex.join(command.words)}: {ratio:.2f} x processor time, {own.wall_s / wall_s:.2f} x wall time"
        print(f"{line}, {own.memory_mb:.0f} MB (target: {target})")
    print("All targets are met." if met else "MISSED: not all targets are met.")


def summary(runs: list[Cost]) -> Cost:
    """Return the medians of the times and the largest memory."""
    cpu_s, wall_s = (statistics.median(times) for times in ([run.cpu_s for run in runs], [run.wall_s for run in runs]))
    return Cost(cpu_s, wall_s, max(run.memory_mb for run in runs))


if __name__ == "__main__":
    main()

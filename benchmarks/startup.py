"""Measure the time and memory of short commands, relative to ``python -c "import numpy, cv2, pydantic"``.

    python benchmarks/startup.py [--rounds N]

The reference and the commands are run in turn, so that other load on the machine slows all of them equally. The benchmark prints
the medians of processor time and wall-clock time as multiples of those of the reference, the maximum memory, and the targets for
processor time and memory. The first run of each command is not measured, because it compiles bytecode and fills caches.
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
    """A command with its targets.

    Attributes:
        arguments: Arguments of ``scope``.
        max_ratio: Maximum processor time as a multiple of that of the reference.
        max_memory_mb: Maximum memory in MB; None if there is no target.
    """

    arguments: list[str]
    max_ratio: float
    max_memory_mb: float | None = None


COMMANDS = (
    Command(["--help"], 1.2),
    Command(["tools"], 1.2),
    Command(["plan", "pan right 20, then tilt down 10"], 1.7),
    Command(["ask", "pan right 5"], 5.0, 350.0),
)


class Cost(NamedTuple):
    """Processor time, wall-clock time and peak memory of one process."""

    cpu_s: float
    wall_s: float
    memory_mb: float


def cost(command: list[str], folder: str) -> Cost:
    """Run a command in a folder and return its cost. Exit with a message if the command fails."""
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
    programs = [[sys.executable, "-m", "scope_ptz.cli", *command.arguments] for command in COMMANDS]
    reference_costs: list[Cost] = []
    costs: list[list[Cost]] = [[] for _ in COMMANDS]
    with tempfile.TemporaryDirectory() as folder:
        for program in (reference, *programs):
            cost(program, folder)
        for _ in range(rounds):
            reference_costs.append(cost(reference, folder))
            for program, runs in zip(programs, costs, strict=True):
                runs.append(cost(program, folder))
    cpu_s, wall_s, memory_mb = summary(reference_costs)
    print(f'reference: {cpu_s:.2f} s of processor time, {wall_s:.2f} s, {memory_mb:.0f} MB (python -c "{REFERENCE}")')
    met = True
    for command, runs in zip(COMMANDS, costs, strict=True):
        measured = summary(runs)
        ratio = measured.cpu_s / cpu_s
        target = f"{command.max_ratio:g} x" + (f", {command.max_memory_mb:g} MB" if command.max_memory_mb else "")
        met = met and ratio <= command.max_ratio and measured.memory_mb <= (command.max_memory_mb or measured.memory_mb)
        times = f"{ratio:.2f} x processor time, {measured.wall_s / wall_s:.2f} x wall-clock time"
        print(f"scope {shlex.join(command.arguments)}: {times}, {measured.memory_mb:.0f} MB (target: {target})")
    print("All targets are met." if met else "MISSED: not all targets are met.")


def summary(runs: list[Cost]) -> Cost:
    """Return the medians of the times and the maximum memory."""
    cpu_s, wall_s = (statistics.median(times) for times in ([run.cpu_s for run in runs], [run.wall_s for run in runs]))
    return Cost(cpu_s, wall_s, max(run.memory_mb for run in runs))


if __name__ == "__main__":
    main()

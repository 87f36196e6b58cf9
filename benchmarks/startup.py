"""Measure the time and memory of short commands, relative to ``python -c "import numpy, cv2, pydantic"``.

    python benchmarks/startup.py [--rounds N]

The reference and the commands run alternately, so that other load on the machine affects all of them equally. The output is the
median processor time, the median wall time and the peak memory of each.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

REFERENCE = "import numpy, cv2, pydantic"
COMMANDS = (["--help"], ["tools"], ["plan", "pan right 5"], ["ask", "pan right 5", "--fast"])


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
    commands = {" ".join(words): [sys.executable, "-m", "scope_ptz.cli", *words] for words in COMMANDS}
    with tempfile.TemporaryDirectory() as folder:
        for command in (reference, *commands.values()):
            cost(command, folder)  # warm-up: compiles bytecode and fills the file cache
        references: list[Cost] = []
        costs: dict[str, list[Cost]] = {name: [] for name in commands}
        for _ in range(rounds):
            references.append(cost(reference, folder))
            for name, command in commands.items():
                costs[name].append(cost(command, folder))
    cpu, wall = (statistics.median(run[n] for run in references) for n in (0, 1))
    print(f"reference: {cpu:.2f} s of processor time, {wall:.2f} s of wall time, {max(run.memory_mb for run in references):.0f} MB")
    for name, runs in costs.items():
        cpu_ratio, wall_ratio = statistics.median(r.cpu_s for r in runs) / cpu, statistics.median(r.wall_s for r in runs) / wall
        print(
            f"scope {name}: {cpu_ratio:.1f} x processor time, {wall_ratio:.1f} x wall time, {max(r.memory_mb for r in runs):.0f} MB"
        )


if __name__ == "__main__":
    main()

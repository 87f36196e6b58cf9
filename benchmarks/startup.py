"""Time and memory of short commands, as multiples of ``python -c "import numpy, cv2, pydantic"`` in the same run.

    python benchmarks/startup.py [--rounds N]

The reference and the commands take turns, so that a busy machine slows all of them alike. Printed are medians of processor time
and of wall time, and the largest memory.
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
    """The cost of one process."""

    cpu_s: float
    wall_s: float
    memory_mb: float


def cost(command: list[str], folder: str) -> Cost:
    """Run a command and return its cost."""
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
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--rounds", type=int, default=7, help="runs of each command")
    rounds = arguments.parse_args().rounds
    reference = [sys.executable, "-c", REFERENCE]
    commands = {" ".join(words): [sys.executable, "-m", "scope_ptz.cli", *words] for words in COMMANDS}
    with tempfile.TemporaryDirectory() as folder:
        for command in (reference, *commands.values()):
            cost(command, folder)  # compiles bytecode and fills the file cache
        base: list[Cost] = []
        costs: dict[str, list[Cost]] = {name: [] for name in commands}
        for _ in range(rounds):
            base.append(cost(reference, folder))
            for name, command in commands.items():
                costs[name].append(cost(command, folder))
    cpu, wall = (statistics.median(run[n] for run in base) for n in (0, 1))
    print(f"reference: {cpu:.2f} s of processor time, {wall:.2f} s, {max(run.memory_mb for run in base):.0f} MB")
    for name, runs in costs.items():
        of_cpu, of_wall = statistics.median(r.cpu_s for r in runs) / cpu, statistics.median(r.wall_s for r in runs) / wall
        print(f"scope {name}: {of_cpu:.1f} x processor time, {of_wall:.1f} x wall time, {max(r.memory_mb for r in runs):.0f} MB")


if __name__ == "__main__":
    main()

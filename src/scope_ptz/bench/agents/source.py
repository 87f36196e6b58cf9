"""Find the source of an external agent without importing it, because importing would run its code in the scorer's process."""

from __future__ import annotations

import hashlib
import importlib
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.machinery import PathFinder
from pathlib import Path

from scope_ptz.errors import ConfigError

DIGEST_CHARS = 16
"""Length of a digest in hexadecimal characters."""
INTERPRETER_S = 60.0
"""Seconds for an interpreter to describe itself."""
_DESCRIBE = "import json, sys; print(json.dumps([sys.prefix, sys.base_prefix, [p for p in sys.path if p]]))"


@dataclass(frozen=True, slots=True)
class Interpreter:
    """A Python interpreter.

    Attributes:
        program: Path of the program, as the user named it.
        prefixes: Folders of the environment and of the installation that it is based on.
        search_path: Folders in which it finds modules.
    """

    program: Path
    prefixes: tuple[Path, ...]
    search_path: tuple[Path, ...]


def own_interpreter() -> Interpreter:
    """Return the interpreter that runs SCOPE."""
    return Interpreter(Path(sys.executable), (Path(sys.prefix), Path(sys.base_prefix)), tuple(Path(p) for p in sys.path if p))


def interpreter_at(program: Path, environment: Mapping[str, str]) -> Interpreter:
    """Ask an interpreter where it finds modules.

    Args:
        program: Path of the program.
        environment: The environment variables of the agent.

    Raises:
        ConfigError: The program is missing or is not a Python interpreter.
    """
    try:
        done = subprocess.run(
            [str(program), "-c", _DESCRIBE], env=dict(environment), capture_output=True, timeout=INTERPRETER_S, check=True, cwd="/"
        )
        prefix, base_prefix, search_path = json.loads(done.stdout)
    except (OSError, subprocess.SubprocessError, ValueError) as error:
        raise ConfigError(f"--agent-python is {program}, which is not a working Python interpreter. Correct the path.") from error
    return Interpreter(program, (Path(prefix), Path(base_prefix)), tuple(Path(p) for p in search_path))


@dataclass(frozen=True, slots=True)
class AgentSource:
    """The source of an agent.

    Attributes:
        folder: The folder in which its module or package, or its program, was found.
        files: The files by their name in the digest.
    """

    folder: Path
    files: Mapping[str, Path]

    def digest(self) -> str:
        """Return a digest of the files; empty if there are none.

        Raises:
            ConfigError: A file cannot be read.
        """
        digest = hashlib.sha256()
        for name, path in sorted(self.files.items()):
            try:
                digest.update(f"{name}\0{hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
            except OSError as error:
                raise ConfigError(f"The source of the agent cannot be read: {path}: {error.strerror}.") from error
        return digest.hexdigest()[:DIGEST_CHARS] if self.files else ""


def find_module(agent: str, folder: Path, search_path: Sequence[Path]) -> AgentSource | None:
    """Return the source of ``module:Class``: its module, or all Python files of its package.

    Args:
        agent: The name of the class.
        folder: The working folder, which is searched first.
        search_path: The folders that are searched afterwards.

    Returns:
        The source; None if there is no such module on the search path.
    """
    top = agent.partition(":")[0].partition(".")[0]
    importlib.invalidate_caches()
    for place in (folder, *search_path):
        spec = PathFinder.find_spec(top, [str(place)])
        if spec is None:
            continue
        packages = [Path(location) for location in spec.submodule_search_locations or ()]
        files = {path.relative_to(package).as_posix(): path for package in packages for path in package.rglob("*.py")}
        if not packages and spec.has_location and spec.origin:
            files = {Path(spec.origin).name: Path(spec.origin)}
        return AgentSource(place, files)
    return None


def find_command(words: Sequence[str], program: Path, folder: Path) -> AgentSource:
    """Return the source of a command: its program, and the files that its arguments name.

    Args:
        words: The program and its arguments.
        program: Path of the program.
        folder: The working folder.
    """
    arguments = {f"{number} {word}": folder / word for number, word in enumerate(words[1:], start=1) if (folder / word).is_file()}
    return AgentSource(folder, {"program": program, **arguments})

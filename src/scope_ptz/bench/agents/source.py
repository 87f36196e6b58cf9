"""Find an external agent's source files without importing them, because that would run the agent in the scorer's process."""

from __future__ import annotations

import hashlib
import importlib
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.machinery import PathFinder
from pathlib import Path

from scope_ptz.errors import ConfigError

DIGEST_CHARS = 16
"""Length of a source digest in hexadecimal characters."""


@dataclass(frozen=True, slots=True)
class Interpreter:
    """A Python interpreter.

    Attributes:
        program: Path of the program, as given by the user.
        prefixes: Folder of the environment, and folder of the installation that it is based on.
        search_path: Folders that it searches for modules.
    """

    program: Path
    prefixes: tuple[Path, ...]
    search_path: tuple[Path, ...]


def own_interpreter() -> Interpreter:
    """Return the interpreter that runs SCOPE."""
    return Interpreter(Path(sys.executable), (Path(sys.prefix), Path(sys.base_prefix)), tuple(Path(p) for p in sys.path if p))


def interpreter_at(program: Path) -> Interpreter:
    """Return the interpreter at a path, as described by the files of its environment.

    The interpreter is not run, because the environment belongs to the agent and may contain code that runs at startup.

    Args:
        program: Path of the program.
    """
    installation = program.resolve().parent.parent
    environment = program.parent.parent
    configuration = environment / "pyvenv.cfg"
    prefixes = (environment, installation) if configuration.is_file() else (installation,)
    libraries = [path for prefix in prefixes for path in sorted(prefix.glob("lib*/python3*")) if path.is_dir()]
    packages = [path for library in libraries for path in library.glob("*-packages")]
    linked = [Path(line) for folder in packages for file in sorted(folder.glob("*.pth")) for line in _read_lines(file)]
    return Interpreter(program, prefixes, (*libraries, *packages, *(path for path in linked if path.is_absolute())))


def _read_lines(file: Path) -> list[str]:
    """Return the lines of a file, or no lines if the file cannot be read."""
    try:
        return [line.strip() for line in file.read_text("utf-8", "replace").splitlines()]
    except OSError:
        return []


@dataclass(frozen=True, slots=True)
class AgentSource:
    """The source files of an agent.

    Attributes:
        folder: The folder in which the module, package or program was found.
        files: The files by their names in the digest.
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
                raise ConfigError(f"The agent's source file {path} cannot be read: {error.strerror}.") from error
        return digest.hexdigest()[:DIGEST_CHARS] if self.files else ""


def find_module_source(agent: str, folder: Path, search_path: Sequence[Path]) -> AgentSource | None:
    """Return the source of the agent ``module:Class``: its module, or all Python files of its package.

    Args:
        agent: The agent's name.
        folder: The working folder, which is searched first.
        search_path: The folders to search afterwards.

    Returns:
        The source; None if the module was not found.
    """
    top = agent.partition(":")[0].partition(".")[0]
    importlib.invalidate_caches()
    for place in (folder, *search_path):
        spec = PathFinder.find_spec(top, [str(place)])
        if spec is None:
            continue
        packages = [Path(location) for location in spec.submodule_search_locations or ()]
        files = {
            path.relative_to(package).as_posix(): path for package in packages for path in package.rglob("*.py") if path.is_file()
        }
        if not packages and spec.has_location and spec.origin:
            files = {Path(spec.origin).name: Path(spec.origin)}
        return AgentSource(place, files)
    return None


def find_command_source(words: Sequence[str], program: Path, folder: Path) -> AgentSource:
    """Return the source of an agent command: its program, and the files named by its arguments.

    Args:
        words: The program and its arguments.
        program: Path of the program.
        folder: The working folder.
    """
    arguments = {f"{number} {word}": folder / word for number, word in enumerate(words[1:], start=1) if (folder / word).is_file()}
    return AgentSource(folder, {"program": program, **arguments})

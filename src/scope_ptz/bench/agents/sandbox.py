"""Run an agent in a sandbox: bubblewrap (``bwrap``), without the network, the home folder and the files of the dataset."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.errors import ConfigError

RUNNER = Path("/run/scope/runner.py")
"""Path of the runner in the sandbox."""
CHECK_S = 30.0
"""Seconds for the check that the sandbox works."""
SCRATCH, SHARED_MEMORY = "/tmp", "/dev/shm"  # noqa: S108 - private folders of the sandbox
SCRATCH_BYTES = 1_000_000_000
"""Size of the private /tmp and of shared memory, each."""
_SYSTEM = ("usr", "bin", "sbin", "lib", "lib32", "lib64", "libx32")
_SYSTEM_FILES = (
    "ld.so.cache", "ld.so.conf", "ld.so.conf.d", "ssl", "ca-certificates", "alternatives", "localtime", "passwd", "group",
    "fonts", "mime.types",
)  # fmt: skip
_PACKAGES = ("scope_ptz", "scope_studio", "scope_addon")
_INSTALLATIONS = (
    "", "*/", "src/", "*/src/", "lib*/python*/*-packages/", "local/lib*/python*/*-packages/", "*/lib*/python*/*-packages/",
    "envs/*/lib*/python*/*-packages/",
)  # fmt: skip
_ISOLATED = ("--unshare-all", "--die-with-parent", "--new-session", "--cap-drop", "ALL")


# If SCOPE runs as root, so does the agent, and /proc has files that root can write without any capability.
_KERNEL = ("--proc", "/proc", "--remount-ro", "/proc", "--dev", "/dev")


@dataclass(frozen=True, slots=True)
class SandboxContents:
    """What a sandbox shows and hides.

    Attributes:
        folder: The agent's own folder, which is the working folder; None for an agent in the interpreter's environment.
        shown: Further folders and files: the interpreter's environment.
        runner: The runner's file; None for an agent that is not a class.
        hidden: Folders and files that are hidden where they lie within what is shown.
    """

    folder: Path | None
    shown: tuple[Path, ...]
    runner: Path | None
    hidden: tuple[Path, ...]


def own_files() -> tuple[Path, ...]:
    """Return the folders of SCOPE itself: the package, and the checkout that it belongs to."""
    package = Path(__file__).resolve().parents[2]
    checkout = package.parent.parent
    return (package, checkout) if package.parent.name == "src" and (checkout / "pyproject.toml").is_file() else (package,)


def require_sandbox() -> None:
    """Check that sandboxes can be created.

    Raises:
        ConfigError: bubblewrap is missing, or the system does not permit it.
    """
    if shutil.which("bwrap") is None:
        raise ConfigError("--sandbox needs bubblewrap. Install it, for example with: apt-get install bubblewrap")
    try:
        command = ["bwrap", *_ISOLATED, "--ro-bind", "/", "/", "--proc", "/proc", "--dev", "/dev", "true"]
        done = subprocess.run(command, capture_output=True, timeout=CHECK_S, check=False)
        problem = done.stderr.decode(errors="replace").strip() if done.returncode else ""
    except (OSError, subprocess.SubprocessError) as error:
        problem = str(error)
    else:
        if done.returncode == 0:
            return
    raise ConfigError(
        f"--sandbox cannot be used here, because bubblewrap cannot create a namespace: {problem or 'unknown reason'}. "
        "Permit user namespaces on this machine, or run without --sandbox."
    )


def sandboxed(command: Sequence[str], contents: SandboxContents) -> tuple[str, ...]:
    """Return the command that runs another one in the sandbox.

    Args:
        command: The program and its arguments.
        contents: What the sandbox shows and hides.

    Raises:
        ConfigError: The agent's folder contains, or lies in, a folder that must not be visible as a whole.
    """
    folder = contents.folder
    if folder is not None:
        _check_folder(folder.resolve(), contents.hidden)
    options = ["bwrap", *_ISOLATED, "--hostname", "agent", *_KERNEL, *_scratch(SHARED_MEMORY), *_scratch(SCRATCH)]
    options += _system()
    mounts = [Path("/usr")]
    for path in (*contents.shown, *([folder] if folder is not None else [])):
        if not any(path.is_relative_to(mount) for mount in mounts):
            options += ["--ro-bind", str(path), str(path)]
            mounts.append(path)
    for path in _masked(mounts, contents.hidden):
        options += ["--tmpfs", str(path), "--remount-ro", str(path)] if path.is_dir() else ["--ro-bind", "/dev/null", str(path)]
    if contents.runner is not None:
        options += ["--ro-bind", str(contents.runner), str(RUNNER)]
    return (*options, "--remount-ro", "/", "--chdir", str(folder or SCRATCH), "--", *command)


def _check_folder(folder: Path, hidden: Sequence[Path]) -> None:
    home = Path.home().resolve()
    if folder == Path("/") or home.is_relative_to(folder):
        raise ConfigError(
            f"--sandbox shows the agent its own folder, but {folder} contains the home folder. Start from another folder."
        )
    for path in (path.resolve() for path in hidden):
        if folder.is_relative_to(path):
            raise ConfigError(
                f"The agent's folder {folder} is in {path}, which --sandbox hides. "
                "Copy the agent to a folder of its own and start there."
            )


def _scratch(path: str) -> list[str]:
    return ["--size", str(SCRATCH_BYTES), "--tmpfs", path]


def _system() -> list[str]:
    """Return the options that show the operating system's programs and libraries."""
    options: list[str] = []
    for name in _SYSTEM:
        path = Path("/") / name
        if path.is_symlink():
            options += ["--symlink", str(path.readlink()), str(path)]
        elif path.is_dir():
            options += ["--ro-bind", str(path), str(path)]
    for name in _SYSTEM_FILES:
        options += ["--ro-bind-try", f"/etc/{name}", f"/etc/{name}"]
    return options


def _masked(mounts: Sequence[Path], hidden: Sequence[Path]) -> list[Path]:
    """Return the paths that must be covered: what is hidden, and every installation of SCOPE, within what is shown."""
    masked: set[Path] = set()
    for mount in mounts:
        place = mount.resolve()
        installed = [path for pattern in _INSTALLATIONS for name in _PACKAGES for path in place.glob(f"{pattern}{name}")]
        for path in (path.resolve() for path in (*hidden, *installed) if path.exists()):
            if path != place and path.is_relative_to(place):
                masked.add(mount / path.relative_to(place))
    return sorted(path for path in masked if not any(path != other and path.is_relative_to(other) for other in masked))

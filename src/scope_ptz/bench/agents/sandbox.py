"""Run an agent in a bubblewrap sandbox (``bwrap``), without access to the network, the home folder and the dataset's files."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.errors import ConfigError

RUNNER = Path("/run/scope/runner.py")
"""Path of the runner inside the sandbox."""
CHECK_S = 30.0
"""Timeout in seconds for checking whether the sandbox works."""
SCRATCH, SHARED_MEMORY = "/tmp", "/dev/shm"  # noqa: S108 - private folders of the sandbox
SCRATCH_BYTES = 1_000_000_000
"""Size of the private ``/tmp`` and of shared memory, each in bytes."""
_SYSTEM_FOLDERS = ("usr", "bin", "sbin", "lib", "lib32", "lib64", "libx32")
_SYSTEM_FILES = (
    "ld.so.cache", "ld.so.conf", "ld.so.conf.d", "ssl", "ca-certificates", "alternatives", "localtime", "passwd", "group",
    "fonts", "mime.types",
)  # fmt: skip
_PACKAGES = ("scope_ptz", "scope_studio", "scope_addon")
_INSTALLATIONS = (
    "", "*/", "src/", "*/src/", "lib*/python*/*-packages/", "local/lib*/python*/*-packages/", "*/lib*/python*/*-packages/",
    "envs/*/lib*/python*/*-packages/",
)  # fmt: skip
_ISOLATION_OPTIONS = ("--unshare-all", "--die-with-parent", "--new-session", "--cap-drop", "ALL")


# If SCOPE runs as root, so does the agent, and root can write to some files in /proc even without capabilities.
_KERNEL_OPTIONS = ("--proc", "/proc", "--remount-ro", "/proc", "--dev", "/dev")


@dataclass(frozen=True, slots=True)
class SandboxContents:
    """The files that are visible and hidden in a sandbox.

    Attributes:
        folder: The agent's folder, which becomes the working folder; None for an agent in the interpreter's environment.
        shown: Other visible folders and files, such as the interpreter's environment.
        runner: The runner's file; None for an agent that is not a class.
        hidden: Folders and files to hide if they are inside a visible folder.
    """

    folder: Path | None
    shown: tuple[Path, ...]
    runner: Path | None
    hidden: tuple[Path, ...]


def own_folders() -> tuple[Path, ...]:
    """Return SCOPE's own folders: the package, and the checkout that contains it, if any."""
    package = Path(__file__).resolve().parents[2]
    checkout = package.parent.parent
    return (package, checkout) if package.parent.name == "src" and (checkout / "pyproject.toml").is_file() else (package,)


def require_sandbox() -> None:
    """Check that a sandbox can be created.

    Raises:
        ConfigError: bubblewrap is not installed, or the system does not permit sandboxes.
    """
    if shutil.which("bwrap") is None:
        raise ConfigError("--sandbox requires bubblewrap. Install it, for example with: apt-get install bubblewrap")
    try:
        command = ["bwrap", *_ISOLATION_OPTIONS, "--ro-bind", "/", "/", "--proc", "/proc", "--dev", "/dev", "true"]
        result = subprocess.run(command, capture_output=True, timeout=CHECK_S, check=False)
        problem = result.stderr.decode(errors="replace").strip() if result.returncode else ""
    except (OSError, subprocess.SubprocessError) as error:
        problem = str(error)
    else:
        if result.returncode == 0:
            return
    raise ConfigError(
        f"--sandbox cannot be used here, because bubblewrap cannot create a namespace: {problem or 'unknown reason'}. "
        "Permit user namespaces on this machine, or run without --sandbox."
    )


def sandbox_command(command: Sequence[str], contents: SandboxContents) -> tuple[str, ...]:
    """Return the command line that runs a command in the sandbox.

    Args:
        command: The program and its arguments.
        contents: The files that are visible and hidden in the sandbox.

    Raises:
        ConfigError: The agent's folder contains the home folder or is inside a hidden folder.
    """
    folder = contents.folder
    if folder is not None:
        _check_folder(folder.resolve(), contents.hidden)
    options = [
        "bwrap",
        *_ISOLATION_OPTIONS,
        "--hostname",
        "agent",
        *_KERNEL_OPTIONS,
        *_tmpfs_options(SHARED_MEMORY),
        *_tmpfs_options(SCRATCH),
    ]
    options += _system_options()
    mounts = [Path("/usr")]
    for path in (*contents.shown, *([folder] if folder is not None else [])):
        if not any(path.is_relative_to(mount) for mount in mounts):
            options += ["--ro-bind", str(path), str(path)]
            mounts.append(path)
    for path in _paths_to_mask(mounts, contents.hidden):
        options += ["--tmpfs", str(path), "--remount-ro", str(path)] if path.is_dir() else ["--ro-bind", "/dev/null", str(path)]
    if contents.runner is not None:
        options += ["--ro-bind", str(contents.runner), str(RUNNER)]
    return (*options, "--remount-ro", "/", "--chdir", str(folder or SCRATCH), "--", *command)


def _check_folder(folder: Path, hidden: Sequence[Path]) -> None:
    home = Path.home().resolve()
    if folder == Path("/") or home.is_relative_to(folder):
        raise ConfigError(
            f"--sandbox makes the agent's folder visible, but {folder} contains the home folder. Run the command in another folder."
        )
    for path in (path.resolve() for path in hidden):
        if folder.is_relative_to(path):
            raise ConfigError(
                f"The agent's folder {folder} is in {path}, which --sandbox hides. "
                "Copy the agent to a separate folder, and run the command there."
            )


def _tmpfs_options(path: str) -> list[str]:
    return ["--size", str(SCRATCH_BYTES), "--tmpfs", path]


def _system_options() -> list[str]:
    """Return the options that make the operating system's programs and libraries visible."""
    options: list[str] = []
    for name in _SYSTEM_FOLDERS:
        path = Path("/") / name
        if path.is_symlink():
            options += ["--symlink", str(path.readlink()), str(path)]
        elif path.is_dir():
            options += ["--ro-bind", str(path), str(path)]
    for name in _SYSTEM_FILES:
        options += ["--ro-bind-try", f"/etc/{name}", f"/etc/{name}"]
    return options


def _paths_to_mask(mounts: Sequence[Path], hidden: Sequence[Path]) -> list[Path]:
    """Return the paths to mask: all hidden paths and installations of SCOPE inside visible folders."""
    masked: set[Path] = set()
    for mount in mounts:
        place = mount.resolve()
        installed = [path for pattern in _INSTALLATIONS for name in _PACKAGES for path in place.glob(f"{pattern}{name}")]
        for path in (path.resolve() for path in (*hidden, *installed) if path.exists()):
            if path != place and path.is_relative_to(place):
                masked.add(mount / path.relative_to(place))
    return sorted(path for path in masked if not any(path != other and path.is_relative_to(other) for other in masked))

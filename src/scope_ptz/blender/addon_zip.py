"""Build the installable zip file for the Blender add-on."""

from __future__ import annotations

import importlib.util
import zipfile
from io import BytesIO
from pathlib import Path

from scope_ptz.errors import BlenderError, OutputError

PACKAGE = "scope_addon"
_DATE = (1980, 1, 1, 0, 0, 0)  # fixed, so that identical sources give identical zip files


def addon_folder() -> Path:
    """Return the folder that contains the add-on's sources, without importing them.

    Raises:
        BlenderError: The sources are not installed.
    """
    spec = importlib.util.find_spec(PACKAGE)
    if spec is None or not spec.submodule_search_locations:
        raise BlenderError("The add-on's sources are not installed. Reinstall scope-ptz.")
    return Path(next(iter(spec.submodule_search_locations)))


def addon_zip() -> bytes:
    """Return the add-on's zip file. Blender 3.4 to 4.1 installs it as an add-on, and 4.2 or later as an extension.

    Raises:
        BlenderError: The add-on's sources are not installed.
    """
    folder, content = addon_folder(), BytesIO()
    files = sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".toml"))
    with zipfile.ZipFile(content, "w") as archive:
        for path in files:
            # An add-on needs a folder in the zip file; an extension allows one.
            entry = zipfile.ZipInfo(f"{PACKAGE}/{path.relative_to(folder).as_posix()}", _DATE)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, path.read_bytes())
    return content.getvalue()


def write_addon_zip(path: Path) -> None:
    """Write the add-on's zip file.

    Raises:
        OutputError: The file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(addon_zip())
    except OSError as error:
        raise OutputError(f"The file {path} cannot be written: {error.strerror}.") from error

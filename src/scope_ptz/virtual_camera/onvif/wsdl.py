"""The message types of all services, loaded from their WSDL files once per process."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, cast

from zeep import Settings
from zeep.transports import Transport
from zeep.wsdl import Document

from scope_ptz.errors import ConfigError

DEVICE = "http://www.onvif.org/ver10/device/wsdl"
IMAGING = "http://www.onvif.org/ver20/imaging/wsdl"
MEDIA = "http://www.onvif.org/ver10/media/wsdl"
MEDIA2 = "http://www.onvif.org/ver20/media/wsdl"
PTZ = "http://www.onvif.org/ver20/ptz/wsdl"
SCHEMA = "http://www.onvif.org/ver10/schema"

_PREFIXES = {
    "tds": DEVICE,
    "trt": MEDIA,
    "tr2": MEDIA2,
    "tptz": PTZ,
    "timg": IMAGING,
    "tt": SCHEMA,
}  # the namespace prefixes used in the ONVIF specifications
_OWN_FOLDER = Path(__file__).parent / "wsdl"
_INSTALL = "Install them with: pip install 'scope-ptz[serve]'"


@cache
def load_document() -> Document:
    """Load the WSDL document for all services. The first call takes about 0.3 s.

    The WSDL files for device, media, PTZ and imaging are from onvif-zeep-async; the file for media2 is in this package.

    Raises:
        ConfigError: The WSDL files are not installed.
    """
    folders = (_OWN_FOLDER, _library_folder())

    class LocalFiles(Transport):
        """Loads documents by file name from the two folders, never from the network."""

        def load(self, url: str) -> bytes:
            name = Path(url).name
            for folder in folders:
                if (folder / name).is_file():
                    return (folder / name).read_bytes()
            raise ConfigError(f"The WSDL file {name} is missing. {_INSTALL}")

    transport: Any = LocalFiles
    document: Any = Document(str(_OWN_FOLDER / "services.wsdl"), transport(), settings=Settings())
    for prefix, namespace in _PREFIXES.items():
        document.types.set_ns_prefix(prefix, namespace)
    return cast("Document", document)


@cache
def load_operations() -> dict[tuple[str, str], Any]:
    """Return the operations of all services, keyed by service namespace and operation name."""
    operations = {}
    for service in load_document().services.values():
        for port in service.ports.values():
            for name, operation in port.binding.all().items():
                operations[port.binding.name.namespace, name] = operation
    return operations


def _library_folder() -> Path:
    # Locate the package without importing it, because an import would load its client and all dependencies.
    spec = find_spec("onvif")
    for location in (spec.submodule_search_locations if spec else None) or ():
        if (folder := Path(location) / "wsdl") and (folder / "ptz.wsdl").is_file():
            return folder
    raise ConfigError(f"The ONVIF services of a virtual camera require the WSDL files in onvif-zeep-async. {_INSTALL}")

"""The message types of all services, read from their WSDL documents once per process."""

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
}  # the namespace prefixes that the ONVIF specifications use
_OWN_FOLDER = Path(__file__).parent / "wsdl"
_INSTALL = "Install them with: pip install 'scope-ptz[serve]'"


@cache
def load_document() -> Document:
    """Return the WSDL document of all services. The first call takes about 0.3 s.

    Device, Media, PTZ and Imaging come from files of onvif-zeep-async, and Media2 from a file of this package.

    Raises:
        ConfigError: The WSDL files are not installed.
    """
    folders = (_OWN_FOLDER, _shipped_folder())

    class LocalFiles(Transport):
        """Loads documents by file name from the two folders, and never from the network."""

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
    """Return the operations of all services by the namespace of their service and their name."""
    found = {}
    for service in load_document().services.values():
        for port in service.ports.values():
            for name, operation in port.binding.all().items():
                found[port.binding.name.namespace, name] = operation
    return found


def _shipped_folder() -> Path:
    # The package is located without importing it, because an import would load its client with all dependencies.
    spec = find_spec("onvif")
    for place in (spec.submodule_search_locations if spec else None) or ():
        if (folder := Path(place) / "wsdl") and (folder / "ptz.wsdl").is_file():
            return folder
    raise ConfigError(f"The ONVIF services of a virtual camera need the WSDL files of onvif-zeep-async. {_INSTALL}")

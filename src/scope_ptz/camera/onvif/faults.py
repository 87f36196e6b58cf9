"""Convert SOAP faults and unreadable replies to camera errors that tell the user what to do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from scope_ptz.camera.network.errors import CameraReplyError, CameraSignInError
from scope_ptz.errors import CameraError

if TYPE_CHECKING:
    from scope_ptz.camera.network.address import DeviceAddress

_SIGN_IN = ("NotAuthorized", "FailedAuthentication", "InvalidSecurity", "FailedCheck")
_MAX_REASON = 200  # maximum number of characters to quote from a device's message


class OnvifFaultError(CameraError):
    """The device refused a request.

    Attributes:
        codes: The fault's code and subcodes, without prefixes.
    """

    def __init__(self, message: str, codes: tuple[str, ...]) -> None:
        super().__init__(message)
        self.codes = codes

    def is_any(self, *codes: str) -> bool:
        """Return whether the fault has one of the codes."""
        return any(code in self.codes for code in codes)


class NotOfferedError(OnvifFaultError):
    """The device does not support the operation."""


@contextmanager
def soap_errors(address: DeviceAddress, operation: str) -> Iterator[None]:
    """Return a context that converts errors of zeep and the ONVIF client to camera errors.

    The original error is dropped, because it may contain the message with its password digest.
    """
    from onvif.exceptions import ONVIFError
    from zeep.exceptions import Error as ZeepError
    from zeep.exceptions import Fault

    try:
        yield
    except CameraError:
        raise
    except Fault as fault:
        failure: CameraError = _error_from_fault(address, operation, fault)
    except ONVIFError as error:
        text = _plain(error.reason)
        failure = CameraReplyError(f"The camera at {address} cannot be used for {operation}: {text}. Check that ONVIF is enabled.")
    except (ZeepError, ValueError, TypeError, AttributeError, LookupError, ArithmeticError):
        failure = CameraReplyError(
            f"The camera at {address} answered {operation} with something that is not valid ONVIF. "
            "Check the address, and that ONVIF is enabled in the camera's settings."
        )
    else:
        return
    raise failure from None


def _error_from_fault(address: DeviceAddress, operation: str, fault: Any) -> CameraError:
    codes = _codes(fault)
    reason = _plain(fault.message or "no reason given")
    if any(code in _SIGN_IN for code in codes):
        return CameraSignInError(
            f"The camera at {address} refuses the account for {operation} ({reason}). Check user name, password and role. "
            "Many cameras have separate ONVIF users, and refuse accounts if their clock is wrong."
        )
    if any(code in ("ActionNotSupported", "OptionalActionNotImplemented", "NotSupported") for code in codes):
        return NotOfferedError(f"The camera at {address} does not offer {operation} ({reason}).", codes)
    return OnvifFaultError(f"The camera at {address} refused {operation}: {reason}. Codes: {', '.join(codes) or 'none'}.", codes)


def _codes(fault: Any) -> tuple[str, ...]:
    found = [fault.code, *(fault.subcodes or [])]
    texts = [getattr(code, "localname", None) or str(code).rpartition("}")[2] for code in found if code is not None]
    return tuple(_plain(text.rpartition(":")[2]) for text in texts)


def _plain(text: object) -> str:
    """Return a device's message as one short printable line."""
    line = " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
    return line[:_MAX_REASON].rstrip(".")

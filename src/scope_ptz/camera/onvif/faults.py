"""Convert SOAP faults and invalid replies to camera errors that tell the user what to do."""

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

    def has_any_code(self, *codes: str) -> bool:
        """Return whether the fault has one of the codes."""
        return any(code in self.codes for code in codes)


class NotOfferedError(OnvifFaultError):
    """The device does not support the operation."""


@contextmanager
def soap_errors(address: DeviceAddress, operation: str) -> Iterator[None]:
    """Return a context manager that converts errors from zeep and the ONVIF client to camera errors.

    The original error is dropped, because it may contain the message with the password digest.
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
        text = _one_line(error.reason)
        failure = CameraReplyError(f"{operation} failed on the camera at {address}: {text}. Check that ONVIF is enabled.")
    except (ZeepError, ValueError, TypeError, AttributeError, LookupError, ArithmeticError):
        failure = CameraReplyError(
            f"The camera at {address} sent an invalid ONVIF reply to {operation}. "
            "Check the address, and check that ONVIF is enabled in the camera's settings."
        )
    else:
        return
    raise failure from None


def _error_from_fault(address: DeviceAddress, operation: str, fault: Any) -> CameraError:
    codes = _codes(fault)
    reason = _one_line(fault.message or "no reason given")
    if any(code in _SIGN_IN for code in codes):
        return CameraSignInError(
            f"The camera at {address} rejected the account for {operation} ({reason}). Check the user name, the password and the "
            "account's role. Many cameras have separate ONVIF users, and reject logins if their clock is wrong."
        )
    if any(code in ("ActionNotSupported", "OptionalActionNotImplemented", "NotSupported") for code in codes):
        return NotOfferedError(f"The camera at {address} does not support {operation} ({reason}).", codes)
    return OnvifFaultError(f"The camera at {address} refused {operation}: {reason}. Codes: {', '.join(codes) or 'none'}.", codes)


def _codes(fault: Any) -> tuple[str, ...]:
    values = [fault.code, *(fault.subcodes or [])]
    texts = [getattr(code, "localname", None) or str(code).rpartition("}")[2] for code in values if code is not None]
    return tuple(_one_line(text.rpartition(":")[2]) for text in texts)


def _one_line(text: object) -> str:
    """Return a device's message as one short printable line."""
    line = " ".join("".join(c if c.isprintable() else " " for c in str(text)).split())
    return line[:_MAX_REASON].rstrip(".")

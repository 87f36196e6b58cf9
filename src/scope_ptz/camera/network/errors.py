"""Network camera errors. Each message tells the user what to do, and none contains a password.

CameraError
├── CameraUnreachableError   nothing responds at the address, or the connection was lost
├── CameraTimeoutError       the camera did not respond in time
├── CameraSignInError        the credentials were rejected, or the account lacks a permission
├── CameraReplyError         a reply violates the protocol
├── NotACameraError          the device at the address is not a camera of the expected type
├── ForeignAddressError      a reply refers to another host, to which credentials are never sent
├── PictureError             a picture is damaged, black or frozen, or has an unexpected size
├── PositionNotReachedError  a move ended at the wrong pose, or did not end in time
└── PictureNotStillError     the encoders report arrival, but the picture is still moving
"""

from __future__ import annotations

from typing import Literal

from scope_ptz.errors import CameraError

PictureFault = Literal["truncated", "damaged", "size", "black", "frozen", "stalled"]
"""The type of fault in a picture or stream."""


class CameraUnreachableError(CameraError):
    """Nothing responds at the camera's address, or the connection was lost."""


class CameraTimeoutError(CameraError):
    """The camera did not respond in time."""


class CameraSignInError(CameraError):
    """The camera rejected the credentials, or the account lacks permission for the request."""


class CameraReplyError(CameraError):
    """A reply from the camera violates the protocol."""


class NotACameraError(CameraError):
    """The device at the address is not a camera of the expected type."""


class ForeignAddressError(CameraError):
    """A reply from the camera refers to another host, to which credentials are never sent."""


class PictureError(CameraError):
    """A picture is damaged, black or frozen, or has an unexpected size.

    Attributes:
        fault: The type of fault.
    """

    def __init__(self, message: str, fault: PictureFault) -> None:
        super().__init__(message)
        self.fault = fault


class PositionNotReachedError(CameraError):
    """A move ended at the wrong pose, or did not end in time."""


class PictureNotStillError(CameraError):
    """The encoders report arrival, but the picture is still moving."""

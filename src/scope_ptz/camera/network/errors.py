"""The errors of network cameras. Each message tells the user what to do, and none contains a password.

CameraError
├── CameraUnreachableError   nothing answers at the address, or the connection breaks
├── CameraTimeoutError       the camera does not answer in time
├── CameraSignInError        the account is refused, or lacks the right for the request
├── CameraReplyError         the reply violates the protocol
├── NotACameraError          something else answers at the address
├── ForeignAddressError      the reply refers to another host, which never gets credentials
├── PictureError             a picture is damaged, black, frozen, or has an unexpected size
├── PositionNotReachedError  a move ends elsewhere, or does not end
└── PictureNotStillError     the encoders report arrival, but the picture keeps moving
"""

from __future__ import annotations

from typing import Literal

from scope_ptz.errors import CameraError

PictureFault = Literal["truncated", "damaged", "size", "black", "frozen", "stalled"]
"""The type of fault in a picture or stream."""


class CameraUnreachableError(CameraError):
    """Nothing answers at the camera's address, or the connection breaks."""


class CameraTimeoutError(CameraError):
    """The camera does not answer in time."""


class CameraSignInError(CameraError):
    """The camera refuses the account, or the account lacks the right for the request."""


class CameraReplyError(CameraError):
    """The camera's reply violates its protocol."""


class NotACameraError(CameraError):
    """Something answers at the address, but it is not a camera of the expected type."""


class ForeignAddressError(CameraError):
    """A reply from the camera refers to another host. Credentials are never sent there."""


class PictureError(CameraError):
    """A picture is damaged, black, frozen, or has an unexpected size.

    Attributes:
        fault: What is wrong with the picture.
    """

    def __init__(self, message: str, fault: PictureFault) -> None:
        super().__init__(message)
        self.fault = fault


class PositionNotReachedError(CameraError):
    """A move ended somewhere else, or did not end in time."""


class PictureNotStillError(CameraError):
    """The encoders report arrival, but the picture keeps moving."""

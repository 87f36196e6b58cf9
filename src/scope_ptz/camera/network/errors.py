"""The errors of cameras on a network. Each message says what to do, and none contains a password.

CameraError
├── CameraUnreachableError   nothing answers at the address, or the connection breaks
├── CameraTimeoutError       the camera answers too late
├── CameraSignInError        the account is refused, or may not do this
├── CameraReplyError         the reply is not what the protocol says
├── NotACameraError          something answers, and it is no camera of this kind
├── ForeignAddressError      the camera points to another host, to which no credentials go
├── PictureError             a picture is damaged, black, frozen, or has another size
├── PositionNotReachedError  a move ends elsewhere, or does not end
└── PictureNotStillError     the encoders report arrival, and the picture keeps moving
"""

from __future__ import annotations

from typing import Literal

from scope_ptz.errors import CameraError

PictureFault = Literal["truncated", "damaged", "size", "black", "frozen", "stalled"]
"""What is wrong with a picture or a stream of pictures."""


class CameraUnreachableError(CameraError):
    """Nothing answers at the camera's address, or the connection breaks."""


class CameraTimeoutError(CameraError):
    """The camera answers too late."""


class CameraSignInError(CameraError):
    """The camera refuses the account, or the account may not do what was asked."""


class CameraReplyError(CameraError):
    """The camera's reply is not what its protocol says."""


class NotACameraError(CameraError):
    """Something answers at the address, and it is not a camera of this kind."""


class ForeignAddressError(CameraError):
    """The camera points to another host. Credentials are never sent there."""


class PictureError(CameraError):
    """A picture is damaged, black, frozen, or has another size.

    Attributes:
        fault: What is wrong.
    """

    def __init__(self, message: str, fault: PictureFault) -> None:
        super().__init__(message)
        self.fault = fault


class PositionNotReachedError(CameraError):
    """A move ended somewhere else, or did not end in time."""


class PictureNotStillError(CameraError):
    """The encoders report arrival, and the picture keeps moving."""

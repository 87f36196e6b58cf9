"""The ground truth sent with a picture, as headers of the HTTP response or the multipart part, and as a JPEG comment."""

from __future__ import annotations

import json
from collections.abc import Mapping

from scope_ptz.virtual_camera.device import Exposure
from scope_ptz.virtual_camera.truth import TruthLog, origin_fields, unix_s


class TruthHeaders:
    """Builds headers and JPEG comments with the ground truth for pictures. Only clients on this machine receive them.

    Args:
        log: The log of the camera's exposures.
    """

    def __init__(self, log: TruthLog) -> None:
        self.log = log

    def of(self, exposure: Exposure) -> tuple[Mapping[str, str], str]:
        """Return the headers for an exposure, and the same data as JSON for a JPEG comment.

        ``X-Scope-Time`` is the scene time and ``X-Scope-Taken`` the Unix time of the exposure, both in seconds.
        """
        origin, taken_s = self.log.origin(exposure), unix_s(exposure)
        pose = origin.pose
        headers = {
            "X-Scope-Scene": origin.scene,
            "X-Scope-Viewpoint": origin.viewpoint,
            "X-Scope-Time": repr(origin.time_s),
            "X-Scope-Taken": repr(taken_s),
            "X-Scope-Pose": f"pan={pose.pan_deg!r};tilt={pose.tilt_deg!r};zoom={pose.zoom!r}",
        }
        return headers, json.dumps({**origin_fields(origin), "taken_s": taken_s})

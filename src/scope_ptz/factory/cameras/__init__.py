"""Parse camera specs and open cameras, and read the site file, profiles and passwords."""

from scope_ptz.camera.spec import CameraSpec
from scope_ptz.factory.cameras.opening import OpenCamera, open_camera
from scope_ptz.factory.cameras.parsing import BUILT_IN_SCHEMES, camera_names, parse_camera

__all__ = ["BUILT_IN_SCHEMES", "CameraSpec", "OpenCamera", "camera_names", "open_camera", "parse_camera"]

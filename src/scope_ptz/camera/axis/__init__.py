"""The driver of AXIS cameras: VAPIX requests and replies, what a device can do, and the camera itself."""

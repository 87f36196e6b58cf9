"""The driver for AXIS cameras: VAPIX requests and replies, device capabilities, and the camera itself."""

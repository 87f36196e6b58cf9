"""VAPIX, the protocol of AXIS cameras: pure functions from a device and the arguments of a request to a reply."""

"""VAPIX, the protocol of AXIS cameras: functions that execute a request on a device and return the reply, independently of HTTP."""

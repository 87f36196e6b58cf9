"""VAPIX, the protocol of AXIS cameras: functions that carry out a request and return the reply, independently of HTTP."""

"""The ONVIF interface of a virtual camera: Device, Media, Media2 and PTZ services, and WS-Discovery."""

"""A virtual camera's ONVIF interface: the device, media, media2, imaging and PTZ services, and WS-Discovery."""

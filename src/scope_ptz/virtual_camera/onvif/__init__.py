"""The ONVIF interface of a virtual camera: Device, Media, Media2, Imaging and PTZ services, and WS-Discovery."""

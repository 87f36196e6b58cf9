"""The driver for ONVIF cameras: the client for a device's services, coordinate spaces, pictures, and the camera itself."""

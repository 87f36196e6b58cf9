"""The driver of ONVIF cameras: services on one pinned host, coordinate spaces, pictures, and the camera itself."""

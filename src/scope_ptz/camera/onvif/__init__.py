"""The driver for ONVIF cameras: services of one device, coordinate spaces, pictures, and the camera itself."""

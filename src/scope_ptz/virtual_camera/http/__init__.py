"""The HTTP server for virtual cameras: authentication, faults, pictures and streams. Each camera has its own port."""

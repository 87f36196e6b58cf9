"""The HTTP server of virtual cameras: sign-in, faults, pictures and streams. Each camera has its own port."""

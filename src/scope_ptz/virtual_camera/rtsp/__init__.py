"""The RTSP server for virtual cameras: H.264 over RTP, interleaved in TCP or over UDP."""

"""The RTSP server of virtual cameras: H.264 over RTP, interleaved in TCP or by UDP."""

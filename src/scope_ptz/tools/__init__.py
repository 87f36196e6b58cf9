"""The nine tools from the paper, which depend only on the camera and perception contracts."""

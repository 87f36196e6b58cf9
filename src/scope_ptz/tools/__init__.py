"""The nine tools of the paper. They depend only on the camera and perception contracts."""

"""The nine tools of the paper, written against the camera and perception contracts only."""

"""Code that network camera drivers share: HTTP that sends credentials only to the camera, pictures, streams, settling, and a dead man's switch."""

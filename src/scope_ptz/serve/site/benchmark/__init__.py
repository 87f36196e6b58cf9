"""Evaluations that clients start on the server. Each runs in a separate process and stores its files in its own folder."""

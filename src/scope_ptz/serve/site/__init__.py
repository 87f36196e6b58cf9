"""A server's services, independent of HTTP: cameras and their control, models, runs, conversations and evaluations."""

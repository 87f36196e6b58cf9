"""The services of a server, independent of HTTP: cameras and their control, models, runs, conversations and evaluations."""

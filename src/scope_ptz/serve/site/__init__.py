"""The services of a server, independent of HTTP: cameras and control of them, pairs of models, runs, conversations and
evaluations."""

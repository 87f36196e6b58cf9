"""What a server offers, without HTTP: cameras and who controls them, pairs of models, runs, conversations and evaluations."""

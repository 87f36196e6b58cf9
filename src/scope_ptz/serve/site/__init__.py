"""The served site: cameras with their control, pairs of models, runs and conversations. This package does not depend on HTTP."""

"""From steps as written to steps that can run: names resolved to presets and things, questions made direct."""

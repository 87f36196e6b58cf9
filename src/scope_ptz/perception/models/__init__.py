"""Code that model backends share: picture encoding, prompts, reply parsing, coordinates, panoramas and routing."""

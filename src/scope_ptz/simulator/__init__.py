"""The simulator: viewpoint packs, re-projection, moving actors, the scene clock and the exact ground truth of every view."""

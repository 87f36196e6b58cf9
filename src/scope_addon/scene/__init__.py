"""The camera in the open scene. These modules run on Blender's main thread only."""

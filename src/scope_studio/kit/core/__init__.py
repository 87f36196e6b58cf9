"""Modelling tools: meshes, solids, lettering, shaders, common materials, and the stage that scenes are placed on."""

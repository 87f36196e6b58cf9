"""The modules of the soak test of the virtual camera. ``virtual_camera_soak.py`` runs the test."""

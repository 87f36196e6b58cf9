"""People: figures, clothing, poses, what they carry."""

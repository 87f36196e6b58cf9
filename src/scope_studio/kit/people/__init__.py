"""People: figures, heads, clothing, poses, and the things that they carry or push."""

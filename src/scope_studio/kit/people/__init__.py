"""People: figures, heads, clothing, poses, and the objects that they carry or push."""

"""The sheets that hold a viewpoint's pictures, and what is done to pictures before they are stored there."""

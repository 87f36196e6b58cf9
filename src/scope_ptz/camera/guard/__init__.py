"""Enforcement of a site's rules between the tools and the camera: limits, keep-out regions, masks, mounting, and an audit log."""

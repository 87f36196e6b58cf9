"""The rules of a site, enforced between the tools and the camera: limits, keep-out regions, masks, mounting, and an audit log."""

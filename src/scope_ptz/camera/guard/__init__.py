"""The rules of a site, enforced between tools and camera: limits, keep-out regions, masks, mounting, and an audit log."""

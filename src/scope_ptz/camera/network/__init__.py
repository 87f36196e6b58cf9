"""What the drivers of network cameras share."""

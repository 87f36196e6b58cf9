"""Read and select the stored pictures of moving actors."""

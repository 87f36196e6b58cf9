"""The report sections below the first screen."""

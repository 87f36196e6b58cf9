"""Parts that backends with a real model share: pictures, prompts, replies, coordinates and panoramas."""

"""Films of finished walks, and the OpenGL drivers that draw them."""

"""Steps of the engine, and what is measured and kept of them."""

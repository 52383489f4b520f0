"""Steps of the engine, and the measurement and recording of their results."""

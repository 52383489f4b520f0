"""Joint commands from flows, and the motion and stability predicted for them."""

"""From intended angles to servo commands: feed-forward, zeros, counts, rate, delay."""

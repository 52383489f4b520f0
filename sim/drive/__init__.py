"""The path from intended angles to servo commands: lead, zero offsets, counts, rate."""

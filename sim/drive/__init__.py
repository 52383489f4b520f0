"""From intended angles to what servos are told: lead, zero offsets, counts, rate."""

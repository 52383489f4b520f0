"""Joint motion from elsewhere: logs of real robots and gaits, read and aligned."""

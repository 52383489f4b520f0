"""Speed, memory and other planners on the same task, side by side in one run."""

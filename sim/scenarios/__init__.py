"""What to walk: scenarios, their settings, paths and obstacles; TOML files."""

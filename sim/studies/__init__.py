"""Studies: what a sweep's table says, in classes, sensitivities and maps."""

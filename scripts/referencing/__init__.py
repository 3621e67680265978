"""The reference set: motions with bounds or errors for every number, in `reference/`."""

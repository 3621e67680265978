"""The films that scripts/film makes of a trajectory, drawn without a browser or a window."""

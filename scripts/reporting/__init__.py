"""The report that scripts/report makes of a study: one HTML page that needs nothing else."""

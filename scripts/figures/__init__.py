"""The figures that scripts/plot draws from the tables of spintop."""

"""Reading the tables of spintop."""

"""What all figures share: look, page, lines, provenance, saving."""

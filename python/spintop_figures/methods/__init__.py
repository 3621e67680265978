"""Figures of studies of methods: work and precision, stability, other programs."""

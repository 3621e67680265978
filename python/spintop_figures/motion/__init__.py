"""Figures of trajectories and of their events."""

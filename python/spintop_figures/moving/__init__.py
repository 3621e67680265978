"""What a page needs of a trajectory to show the top move."""

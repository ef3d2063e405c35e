"""What effects cost, and what they change."""

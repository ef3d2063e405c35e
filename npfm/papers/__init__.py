"""What the papers printed, what they claim, and the page that puts the claims to our tables."""

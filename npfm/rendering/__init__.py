"""From a scene in a light to its transport matrix, and from a table to a picture."""

"""The gallery of a run: pages to turn, flip and read, which a browser opens from disk."""

"""Factors of many materials as a mean curve and a few common ones, in logarithms."""

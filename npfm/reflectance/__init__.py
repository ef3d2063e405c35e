"""What a measurement is: a table of reflectance on a grid, and MERL's file of it."""

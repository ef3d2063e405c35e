"""What accuracy costs in time: settings to compare, and the tables that compare them."""

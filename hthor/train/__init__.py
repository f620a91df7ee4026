"""Data for training robots that learn: houses from seeds, and what a robot sees from every pose in them."""

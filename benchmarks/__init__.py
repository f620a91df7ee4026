"""How fast hthor is: ``python -m benchmarks`` prints it as one table. Nothing here is a test."""

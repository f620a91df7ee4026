"""Processes and the CPU: affinity, cleanup, exit status, resource usage."""

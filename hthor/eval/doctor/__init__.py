"""Checks whether this machine can run evaluations: each file tries out one thing.

A finding says what was found and, if something is wrong, the command that fixes it. Nothing here changes the machine,
leaves a file behind or uses the network.
"""

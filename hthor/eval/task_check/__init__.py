"""Checks whether tasks are sound: an omniscient person solves each task before it is used."""

"""Participants' parameters: priors, populations, kinds, their files. Begin with `population` and `resolve`."""

"""Simulated people: the contract of a human model (`model.HumanModel`) and the parts of the proxy.

Begin with `models.proxy`, whose `Model` shows how perception, memory, search, communication and motor parts work
together; `population` has the parameters of participants, and `population.resolve` finds them by a word of `--humans`.
"""

"""``python -m benchmarks.damage``: files of hthor's that were damaged, and command lines made up at random.

Whatever is done to its input, a command ends with a documented exit code, without a traceback, without a number that
is none, and loses nothing that was there.
"""

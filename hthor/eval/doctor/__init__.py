"""Whether this machine can do what an evaluation needs: each file looks at one thing, really trying it out.

A finding says what was found and, where that is not well, the command that mends it. Nothing here changes the machine,
leaves a file behind or uses the network.
"""

"""What a participant can do in a trial: search, fetch, deliver, follow a message, carry together.

Begin with `behaviours.Behaviours`.
"""

"""Training of robots that learn, and its data: what a robot sees from every pose in houses made from seeds.

Needs the extra ``torch``.
"""

import importlib.util

from hthor.errors import MissingExtra

if importlib.util.find_spec("torch") is None:
    raise MissingExtra("training", "torch")

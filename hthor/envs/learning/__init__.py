"""The episode as environments of Gymnasium and PettingZoo.

Needs the extra ``learn``.
"""

import importlib.util

from hthor.errors import MissingExtra

for _library, _what in (("gymnasium", "Gymnasium"), ("pettingzoo", "PettingZoo")):
    if importlib.util.find_spec(_library) is None:
        raise MissingExtra(f"an environment of {_what}", "learn")

"""Furniture packs: photographed or modelled furniture in the user's cache, which pictures may show instead of hthor's
own. A pack is optional in every way: no part of hthor needs one, and physics never uses it.
"""

from hthor.looks.pack.store import Pack, PackError, find, home, installed, load, overwritable, remove, tidy

__all__ = ["Pack", "PackError", "find", "home", "installed", "load", "overwritable", "remove", "tidy"]

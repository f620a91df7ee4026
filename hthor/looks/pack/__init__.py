"""Furniture packs: photographed or modelled furniture in the user's cache that pictures may show instead of our own. A
pack is optional in every way: nothing needs one, and physics never sees it.
"""

from hthor.looks.pack.store import Pack, PackError, find, home, installed, load, overwritable, remove, tidy

__all__ = ["Pack", "PackError", "find", "home", "installed", "load", "overwritable", "remove", "tidy"]

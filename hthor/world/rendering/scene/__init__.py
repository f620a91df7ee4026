"""The stage of the ``nice`` pictures: a house dressed, with lamps and sky.

Nothing of it takes part in the physics: it is compiled apart, from the house, the looks and the bodies, when someone
asks for the first picture.
"""

CODE_PART = "pictures"

"""The visual model for pictures in the profile ``nice``: the house with furniture meshes, lamps and sky.

It has no part in the physics and is compiled for the first such picture. Begin with `compile_scene`.
"""

CODE_PART = "pictures"

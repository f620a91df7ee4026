"""The visual model for pictures in the profile ``nice``: the house with furniture meshes, lamps and sky.

It takes no part in the physics; it is compiled when the first such picture is asked for. Begin with `compile_scene`.
"""

CODE_PART = "pictures"

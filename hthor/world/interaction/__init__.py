"""The effects of actions on the scene: picking, placing and opening."""

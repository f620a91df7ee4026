"""What every part of a human model shares. Begin with `trial_context.HumanContext`."""

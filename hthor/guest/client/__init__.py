"""What runs in a trial's process, or in ``hthor agent serve``: loads the agent and runs trials with it."""

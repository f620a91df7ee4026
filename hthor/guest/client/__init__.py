"""Code of a trial's process and of ``hthor agent serve``: loads the agent and runs trials with it."""

"""A language model as the person: prompts, backends and cached responses."""

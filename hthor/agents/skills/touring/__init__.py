"""Looking around before a task: `tour` is the policy, `tour_record` what is remembered. Begin with `tour`."""

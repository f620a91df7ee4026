"""The files of a run. Begin with `run_folder`, which opens them; `trial_record` is one line of the log."""

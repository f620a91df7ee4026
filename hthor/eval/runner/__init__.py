"""Running trials: `experiment` is `hthor eval` as a function, `run` one run, `trial_runner` a worker's part."""

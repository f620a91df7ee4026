"""Running trials: `experiment` is `hthor eval` as a function, `run` one run, `session_runner` a worker's part."""

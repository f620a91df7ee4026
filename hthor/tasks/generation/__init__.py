"""Makes tasks: goals, arrangements, starts and their difficulty."""

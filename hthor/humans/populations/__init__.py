"""The populations that ship with hthor, two files each: see `hthor.humans.population.population_file`."""

"""Human models, one file each: the file's name is what `--humans` takes. `proxy` is the model of real people."""

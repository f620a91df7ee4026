"""Where a participant searches next. Begin with `option_choice`; `exploration` carries the choices out."""

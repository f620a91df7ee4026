"""The house of a trial as a glTF file, with the light of its lamps in it. Begin with `house_file`."""

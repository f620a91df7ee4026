"""People take part in trials themselves: a server, real time, and the pages that people open. Begin with `engine`."""

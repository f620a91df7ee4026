"""How built-in robots talk with people: they answer questions, and may ask some. Begin with `conversation`."""

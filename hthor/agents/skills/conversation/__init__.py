"""How built-in robots talk with people: they answer questions, address suggestions, and may ask. Begin with
`conversation`."""

"""From options to runs: `resolve` turns every word of the options into an object, once; nothing later reads a word."""

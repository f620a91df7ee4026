"""One regression per human ability, fitted to features of logged trials."""

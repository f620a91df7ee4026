"""Carrying a thing that is too heavy for one body: who takes which end, who leads, and how it is pulled."""

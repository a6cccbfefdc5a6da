"""Solves the problems of this folder by SciPy. It shares no code with patchcord."""

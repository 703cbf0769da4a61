"""run: text of a generated file becomes a real file and a module (`load`), compiled where Numba is (`compiled`),
called only after its arguments were found apart and of the right shapes (`overlap`)."""

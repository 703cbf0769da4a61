"""Views that NumPy's functions make: which memory they share, and how they are kept coherent with it."""

"""Tests of one room or pass lie in the folder of their room, kernels that are only cases in `corpus`, by topic. Here
are tests of the whole: goldens, simulations, generated programs, the command, the documents, the order of the house."""

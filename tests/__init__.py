"""Tests of one room or pass lie in the folder of their room, kernels that are only cases in `corpus`, by topic, what
tests are made with in `harness`. Here are tests of the whole: the corpus, goldens, simulations, random programs, the
examples, the order of the house."""

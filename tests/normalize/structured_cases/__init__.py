"""Small hostile functions: order of evaluation, laziness, jumps, loops. Each is run as written and in its form."""
from __future__ import annotations

from tests.normalize.structured_cases import assignments, evaluation_order, jumps, loops

HELPERS = '''
def push(x, v):
    x[0] = x[0] * 2.0 + v
    return x[0]
def both(x, v):
    x[1] += v
    return x[1], v - x[0]
def pure(a, b=2.0, c=-1.0):
    return a * b - c
def log(x, v):
    x[2] = x[2] * 10.0 + v
    return v
def reset(x):
    x[:] = 1.0
'''

# Each takes x (four floats, changed in place), n (an integer) and v (a float).
CASES = {name.strip(): body for topic in (evaluation_order, assignments, jumps, loops) for name, body in (
    case.split(":", 1) for case in topic.TEXT.strip("\n").split("\n===\n"))}


def text_of(name: str) -> str:
    body = CASES[name]
    body = "    " + body.strip() + "\n" if not body.startswith("\n") else body
    return HELPERS + f"\ndef case(x, n, v):\n{body}\n"

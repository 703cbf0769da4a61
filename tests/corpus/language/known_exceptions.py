"""try: handlers of what shows before the run; what only the run would raise is refused."""
from __future__ import annotations

import contextlib
from types import SimpleNamespace

import numpy as np

from tests.corpus import Case


class ConvergenceError(RuntimeError):
    pass


class Missing(KeyError):
    pass


class Swallowing:
    def __enter__(self):
        return self

    def __exit__(self, *error):
        return True


def keys(x):
    table, s = {"a": x[0], "b": x[1]}, 0.0
    for key in ("a", "b", "c"):
        try:
            s += 2.0
            s += table[key] ** 2
        except KeyError:
            s += x[2]
        else:
            s *= 1.5
    return s


def attributes(x):
    given = SimpleNamespace(k=x[0])
    try:
        f = given.f
    except AttributeError:
        f = x[1] * 2
    try:
        a = x[1] if hasattr(given, "f") else given.k
        b = getattr(given, "q", x[2])
    except (AttributeError, KeyError):
        a = b = 0.0
    return f * a * b


def looked_up(table, name):
    try:
        return table[name]
    except KeyError:
        return 1.0


def returned(x):
    table = {"a": x[0] ** 2}
    return looked_up(table, "a") * looked_up(table, "b") + x[1]


def strict(mode, x):
    if mode == "fast":
        return x[0] ** 2
    raise NotImplementedError(mode)


def raised_by_a_helper(x):
    try:
        s = strict("slow", x)
    except NotImplementedError as error:  # noqa: F841
        s = x[2] ** 3
    finally:
        t = x[0]
    return s * t


def raised_for_a_size(x):
    try:
        s = x[0] * 3
        if x.size == 3:
            raise ConvergenceError("three")
        s = 0.0
    except ConvergenceError:
        s += x[1] ** 2
    return s


def in_a_loop(x):
    table, s = {}, 0.0
    for _ in range(4):
        try:
            table["n"] += x[0]
        except KeyError:
            table["n"] = x[1]
        s += table["n"] ** 2
    return s


def in_a_branch_of_the_run(x):
    table, s = {"a": x[0]}, 0.0
    if x[1] > 1:
        try:
            s = table["b"]
        except KeyError:
            s = x[2] ** 2
    return s


def whatever_it_is(x):
    table = {"a": x[0]}
    try:
        v = table["q"]
    except Exception:
        v = x[2] ** 2
    return v


def raised_anew(x):
    table = {"f": x[0]}
    try:
        try:
            s = table["q"]
        except AttributeError:
            s = 0.0
        except KeyError as error:
            table["z"] = x[1]
            raise Missing("q") from error
        finally:
            table["f"] = x[1] * x[2]
    except Missing:
        s = table["z"] ** 2 + table["f"]
    return s


def parsed(text):
    try:
        return int(text)
    except ValueError:
        try:
            return float(text)
        except ValueError:
            return text


def parsed_texts(x):
    given = {k.strip(): parsed(v.strip()) for k, v in (
        line.split("=") for line in "n = 3; dt = 0.25; method = euler".split(";"))}
    y = x[0]
    for _ in range(given["n"]):
        y = y + given["dt"] * x[1] * y if given["method"] == "euler" else 0.0
    return y * x[2]


@contextlib.contextmanager
def tolerant(log):
    try:
        yield log
    except KeyError:
        log.append(2.0)
    finally:
        log.append(3.0)


def handled_by_a_manager(x):
    log, table, s = [], {}, x[0]
    with tolerant(log):
        s = s * 2
        s += table["q"]
        s = 100.0
    return s * sum(log)


def yielded(table, x):
    for key in ("a", "b"):
        try:
            yield table[key]
        except KeyError:
            yield x[2]


def around_a_generator(x):
    """What a loop raises does not come to the generator that it goes through."""
    table, s = {"a": x[0]}, 0.0
    try:
        for v in yielded(table, x):
            s += v ** 2
            if v is not None:
                s += table["q"]
    except KeyError:
        s += 3 * x[1]
    for v in yielded(table, x):
        try:
            s += v ** 2
            s += table["q"]
        except KeyError:
            s += 3 * x[1] * v
    return s


def in_an_expression(x):
    table = {"a": x[0]}
    try:
        s = table["b"] if x[1] > 5 else table["a"]
    except KeyError:
        s = 3.0
    return s


def in_a_branch(x):
    table = {"a": x[0]}
    try:
        s = table["b"] if x[0] > 9 else 1.0
        if x[1] > 1:
            s = table["b"]
    except KeyError:
        s = x[2]
    return s


def diverged(x):
    if x[0] > 0.5:
        raise ConvergenceError("x")
    return x[1]


def raised_by_the_run(x):
    try:
        s = diverged(x)
    except ConvergenceError:
        s = x[2] ** 2
    return s


def zero_division(x):
    try:
        v = 1.0 / x[0]
    except ZeroDivisionError:
        v = x[2] ** 2
    return v


def swallowed(x):
    table, s = {}, x[0]
    try:
        with Swallowing():
            s = table["q"]
        s = s * 2
    except KeyError:
        s = 100.0
    return s


EVERY = (keys, attributes, returned, raised_by_a_helper, raised_for_a_size, in_a_loop, in_a_branch_of_the_run,
         whatever_it_is, raised_anew, handled_by_a_manager, around_a_generator, parsed_texts)
WAY_OUT = "test for the bad case with an if before it happens"


def cases():
    x = np.array([0.7, 1.3, 0.4])
    for kernel in EVERY:
        yield Case(kernel, (x,), "x")
    for kernel, part, kind in ((in_an_expression, 'table["b"]', "KeyError"), (in_a_branch, 'table["b"]', "KeyError"),
                               (raised_by_the_run, 'raise ConvergenceError("x")', "ConvergenceError")):
        yield Case(kernel, (x,), refused=f"S201 at `{part}`: only the run knows whether this raises {kind}, inside of "
                   f"a try: {WAY_OUT}")
    yield Case(zero_division, (x,), refused=f"S201 at `try:`: try around what may raise is not supported in a kernel: "
               f"{WAY_OUT}")
    yield Case(swallowed, (x,), refused="S202 at `table[\"q\"]`: 'table' has no key 'q': its keys are ")

"""Lists and structures that a function returns out of a loop that stays, and behind it."""
import numpy as np

from tests.corpus import Case


def solved(b, tolerance, steps):
    x = b * 0.0
    residuals = [np.sum(b ** 2)]
    for _ in range(steps):
        x = x + 0.5 * (b - x)
        residuals.append(np.sum((b - x) ** 2))
        if residuals[-1] < tolerance:
            return x, residuals, True
    return x, residuals, False


def history_and_flag(b, tolerance):
    x, residuals, ok = solved(b, tolerance, 6)
    return x[0] + residuals[-1] + len(residuals) * b[1] + (0.0 if ok else residuals[0])


def halved(b, tolerance):
    rows, count = [], 0
    while True:
        b = b * 0.5
        rows.append(b)
        count += 1
        if np.sum(b) < tolerance:
            return rows
        if count > 8:
            return rows


def returned_at_two_places(b, tolerance):
    rows = halved(b, tolerance)
    total = 0.0
    for r in rows:
        total += np.sum(r ** 2)
    return total + rows[-1][0] * len(rows)


def damped(b, tolerance):
    values, y = [b[0]], b[1]
    for _ in range(3):
        for _ in range(3):
            y = y * 0.8 + b[2] * 0.1
            values.append(y)
            if y < tolerance:
                return y, values
        values.append(y * y)
    return y, values


def out_of_two_loops(b, tolerance):
    y, values = damped(b, tolerance)
    values.append(2.0 * y)
    whole = np.array(values)
    return np.sum(whole ** 2) + y * len(whole)


def logged(b, tolerance, log):
    for _ in range(5):
        b = b * 0.7
        log.append(np.sum(b))
        if log[-1] < tolerance:
            return log
    log.append(b[0])
    return log


def the_list_that_was_given(b, tolerance):
    log = [1.0]
    out = logged(b, tolerance, log)
    out.append(b[1])
    return sum(log) + log[-1] * len(out)


def minimized(b, tolerance):
    best, trace = b[0], {"f": [], "x": []}
    for i in range(6):
        b = b * 0.7
        trace["f"].append(np.sum(b ** 2))
        trace["x"].append(b)
        if trace["f"][-1] < tolerance:
            best = b[0] * 2
            return {"best": best, "trace": trace, "n": i}
    return {"best": best, "trace": trace, "n": 6}


def dictionaries(b, tolerance):
    found = minimized(b, tolerance)
    found["trace"]["f"].append(found["best"])
    return found["best"] + np.sum(np.array(found["trace"]["f"])) + found["trace"]["x"][-1][1] * found["n"]


class Solver:
    def __init__(self):
        self.history = []

    def solve(self, x, tolerance):
        x = x.copy()
        for _ in range(5):
            x = x - 0.3 * np.sin(x)
            self.history.append(np.sum(x))
            if self.history[-1] < tolerance:
                return x, self.history
        return x, self.history


def history_of_an_object(b, tolerance):
    solver = Solver()
    x, first = solver.solve(b, tolerance)
    x, second = solver.solve(x + b, tolerance)
    second.append(x[0])
    return np.sum(np.array(first) ** 2) + len(solver.history) * x[1] + solver.history[-1]


def numbers_that_turn(b, tolerance):
    x, y = b[0], b[1]
    for _ in range(5):
        if x < tolerance:
            return y * b[2]
        x, y = y * 0.6, x
    return x


def cases():
    for kernel in (history_and_flag, returned_at_two_places, out_of_two_loops, the_list_that_was_given, dictionaries,
                   history_of_an_object, numbers_that_turn):
        for tolerance in (0.33, 0.95, -1.0):
            yield Case(kernel, (np.array([1.0, 0.8, 0.6]), tolerance), ("b",))

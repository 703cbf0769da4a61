"""ht: the residuals of hand tracking, and their Jacobian.

A column for each of the parameters is one tangent. Where a point lies in a triangle, its residuals depend on its own
two coordinates there alone: two tangents give the columns of all of them.
"""
import numpy as np

from benchmarks.gradbench.function import Function, array, differentiated, listed, primal
from benchmarks.gradbench.kernels import ht

simple = differentiated(ht.simple, wrt="theta")
complicated = differentiated(ht.complicated, wrt=("theta", "us"))
simple_primal, complicated_primal = primal(ht.simple), primal(ht.complicated)


def arguments(given):
    """The arguments of `kernels.ht.simple`, or those of `complicated` if there are coordinates in triangles."""
    data, us = given["data"], array(given["us"], -1, 2)
    model = data["model"]
    of_model = (np.array(model["parents"]), array(model["base_relatives"], -1, 4, 4),
                array(model["inverse_base_absolutes"], -1, 4, 4), array(model["base_positions"], -1, 4),
                array(model["weights"], -1, len(model["parents"])))
    of_data = bool(model["is_mirrored"]), np.array(data["correspondences"]), array(data["points"], -1, 3)
    theta = array(given["theta"], -1)
    return ((theta, us, *of_model, np.array(model["triangles"]), *of_data) if us.size else (theta, *of_model, *of_data))


def objective(*given):
    """The residuals, point by point."""
    return (simple_primal if len(given) == 9 else complicated_primal)(*given).ravel()


def jacobian(*given):
    """Two columns for the coordinates in triangles, if there are, and one for each parameter."""
    theta, rest = given[0], given[1:]
    directions = np.eye(theta.size)
    if len(given) == 9:
        columns = [simple.tangent(theta, d, *rest) for d in directions]
    else:
        us, rest = rest[0], rest[1:]
        zero, none = np.zeros(theta.size), np.zeros(us.shape)
        columns = [complicated.tangent(theta, zero, us, np.tile(d, (len(us), 1)), *rest) for d in np.eye(2)]
        columns += [complicated.tangent(theta, d, us, none, *rest) for d in directions]
    return np.stack([np.ravel(column) for column in columns], axis=1)


FUNCTIONS = {"objective": Function(arguments, objective, listed), "jacobian": Function(arguments, jacobian, listed)}

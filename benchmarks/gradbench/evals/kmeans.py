"""kmeans: the cost, and the direction of Newton's method, the gradient over the Hessian, which is diagonal.

s2sad writes the adjoint of the cost, and its tangent is the product of the Hessian with a vector: that with ones is the
diagonal. The tangent gives the gradient, too.
"""
import numpy as np

from benchmarks.gradbench.function import Function, array, differentiated, listed, number, primal
from benchmarks.gradbench.kernels import kmeans
from benchmarks.gradbench.written import written
from s2sad import Const, Duplicated, ForwardWithPrimal, autodiff

cost_adjoint = written(kmeans.cost, "adjoint", "centroids", (np.ones((2, 2)), np.ones((2, 2))))


def slopes(points, centroids):
    """The gradient of the cost for the centroids."""
    found = np.zeros(centroids.shape)
    cost_adjoint(points, centroids, found, 1.0)
    return found


product = differentiated(slopes)


def direction(points, centroids):
    """The gradient over the diagonal of the Hessian."""
    ones = np.ones_like(centroids)
    diagonal, gradient = autodiff(ForwardWithPrimal, product, Const(points), Duplicated(centroids, ones))
    return gradient / diagonal


def arguments(given):
    """Points and centroids."""
    points = np.array(given["points"], dtype=np.float64)
    return points, array(given["centroids"], -1, points.shape[1])


FUNCTIONS = {"cost": Function(arguments, primal(kmeans.cost), number), "dir": Function(arguments, direction, listed)}

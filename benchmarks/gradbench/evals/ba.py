"""ba: the residuals of bundle adjustment, and their sparse Jacobian.

A residual depends on one camera, one point and one weight: two adjoints, one for each residual of an observation, give
all rows of the Jacobian, and a third one those of the weights' residuals.
"""
import numpy as np

from benchmarks.gradbench.function import Function, array, differentiated, primal
from benchmarks.gradbench.kernels import ba

projected = differentiated(ba.residuals, wrt=("camera", "point", "weight"), of="out")
regular = differentiated(ba.regularization, wrt="weight", of="out")
residuals, regularization = primal(ba.residuals), primal(ba.regularization)


def arguments(given):
    """Cameras (n, 11), points (m, 3), weights (p), features (p, 2), and which camera and point each observation has."""
    n, m, p = given["n"], given["m"], given["p"]
    number = np.arange(p)
    return (np.tile(array(given["cam"], ba.CAMERA), (n, 1)), np.tile(array(given["x"], 3), (m, 1)),
            np.full(p, float(given["w"])), np.tile(array(given["feat"], 2), (p, 1)), number % n, number % m)


def objective(cameras, points, weights, features, camera, point):
    """All residuals (p, 2), and those of the weights (p)."""
    errors, of_weights = np.empty(features.shape), np.empty(weights.size)
    residuals(cameras[camera], points[point], weights, features, errors)
    regularization(weights, of_weights)
    return errors, of_weights


def jacobian(cameras, points, weights, features, camera, point):
    """The Jacobian in compressed rows: where each row starts, the columns and the values."""
    p, wide = weights.size, ba.CAMERA + 4
    seen, aimed, errors = cameras[camera], points[point], np.empty(features.shape)
    values = np.empty((p, 2, wide))
    for k in range(2):
        seed = np.zeros((p, 2))
        seed[:, k] = 1.0
        camera_bar, point_bar, weight_bar = np.zeros_like(seen), np.zeros_like(aimed), np.zeros(p)
        projected.adjoint(seen, camera_bar, aimed, point_bar, weights, weight_bar, features, errors, seed)
        values[:, k, :ba.CAMERA], values[:, k, ba.CAMERA:-1], values[:, k, -1] = camera_bar, point_bar, weight_bar
    weight_bar = np.zeros(p)
    regular.adjoint(weights, weight_bar, np.empty(p), np.ones(p))
    of_weights = ba.CAMERA * len(cameras) + 3 * len(points) + np.arange(p)
    columns = np.empty((p, 2, wide), dtype=np.int64)
    columns[:, :, :ba.CAMERA] = (ba.CAMERA * camera[:, None] + np.arange(ba.CAMERA))[:, None]
    columns[:, :, ba.CAMERA:-1] = (ba.CAMERA * len(cameras) + 3 * point[:, None] + np.arange(3))[:, None]
    columns[:, :, -1] = of_weights[:, None]
    starts = np.concatenate([wide * np.arange(2 * p), 2 * wide * p + np.arange(p + 1)])
    return starts, np.concatenate([columns.ravel(), of_weights]), np.concatenate([values.ravel(), weight_bar])


def repeated(result, given):
    """The residuals of the first observation, and how often they stand there: all observations are one."""
    errors, of_weights = result
    return {"reproj_error": {"elements": errors[0].tolist(), "repeated": len(errors)},
            "w_err": {"element": float(of_weights[0]), "repeated": len(of_weights)}}


def shortened(result, given):
    """The first 30 entries and the last one of each part."""
    return {name: [*part[:30].tolist(), part[-1].item()] for name, part in zip(("rows", "cols", "vals"), result)}


FUNCTIONS = {"objective": Function(arguments, objective, repeated),
             "jacobian": Function(arguments, jacobian, shortened)}

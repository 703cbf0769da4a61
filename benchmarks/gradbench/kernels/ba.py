"""Bundle adjustment: how far projected points lie from where cameras have seen them."""
import numpy as np

CAMERA = 11   # rotation (3), centre (3), focal length, principal point (2), radial distortion (2)


def rotated(r, x):
    """The point x rotated about the axis r by an angle of |r| (Rodrigues); for r = 0 to first order."""
    square = np.dot(r, r)
    if square == 0.0:
        return x + np.cross(r, x)
    angle = np.sqrt(square)
    axis = r / angle
    return x * np.cos(angle) + np.cross(axis, x) * np.sin(angle) + axis * (np.dot(axis, x) * (1.0 - np.cos(angle)))


def residuals(camera, point, weight, feature, out):
    """Writes the weighted residuals (p, 2) of observations with a camera (p, 11), a point (p, 3), a weight (p) and a
    feature (p, 2) each."""
    for i in range(weight.size):
        seen = rotated(camera[i, :3], point[i] - camera[i, 3:6])
        u, v = seen[0] / seen[2], seen[1] / seen[2]
        square = u * u + v * v
        scale = camera[i, 6] * (1.0 + camera[i, 9] * square + camera[i, 10] * square * square)
        out[i, 0] = weight[i] * (u * scale + camera[i, 7] - feature[i, 0])
        out[i, 1] = weight[i] * (v * scale + camera[i, 8] - feature[i, 1])


def regularization(weight, out):
    """Writes 1 - w^2 for every observation."""
    out[:] = 1.0 - weight * weight

"""Bundle adjustment: how far projected points lie from where cameras have seen them."""
import numpy as np

CAMERA = 11   # rotation (3), centre (3), focal length, principal point (2), radial distortion (2)


def rotate(r, x, y, z, out):
    """Writes the point (x, y, z) rotated about the axis r by an angle of |r| (Rodrigues); for r = 0 to first order."""
    square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    if square == 0.0:
        out[0] = x + r[1] * z - r[2] * y
        out[1] = y + r[2] * x - r[0] * z
        out[2] = z + r[0] * y - r[1] * x
    else:
        angle = np.sqrt(square)
        s, c = np.sin(angle), np.cos(angle)
        u, v, w = r[0] / angle, r[1] / angle, r[2] / angle
        along = (u * x + v * y + w * z) * (1.0 - c)
        out[0] = x * c + (v * z - w * y) * s + u * along
        out[1] = y * c + (w * x - u * z) * s + v * along
        out[2] = z * c + (u * y - v * x) * s + w * along


def residuals(camera, point, weight, feature, out):
    """Writes the weighted residuals (p, 2) of observations with a camera (p, 11), a point (p, 3), a weight (p) and a
    feature (p, 2) each."""
    seen = np.empty(3)
    for i in range(weight.size):
        rotate(camera[i], point[i, 0] - camera[i, 3], point[i, 1] - camera[i, 4], point[i, 2] - camera[i, 5], seen)
        u, v = seen[0] / seen[2], seen[1] / seen[2]
        square = u * u + v * v
        scale = camera[i, 6] * (1.0 + camera[i, 9] * square + camera[i, 10] * square * square)
        out[i, 0] = weight[i] * (u * scale + camera[i, 7] - feature[i, 0])
        out[i, 1] = weight[i] * (v * scale + camera[i, 8] - feature[i, 1])


def regularization(weight, out):
    """Writes 1 - w^2 for every observation."""
    for i in range(weight.size):
        out[i] = 1.0 - weight[i] * weight[i]

"""An image of a smoke volume: rays march through a grid of densities, absorbed and lit, by trilinear reading."""
import numpy as np


def density_at(grid, point):
    n = grid.shape[0]
    position = np.clip(point * (n - 1), 0.0, n - 1.001)
    cell = np.floor(position).astype(np.int64)
    f = position - cell
    i, j, k = cell
    value = 0.0
    for a in range(2):
        for b in range(2):
            for c in range(2):
                weight = ((f[0] if a else 1.0 - f[0]) * (f[1] if b else 1.0 - f[1]) * (f[2] if c else 1.0 - f[2]))
                value += weight * grid[i + a, j + b, k + c]
    return value


def ray_march(grid, light, image, samples=5, absorption=4.0):
    """The image in place; returns its mean brightness."""
    height, width = image.shape
    step = 1.0 / samples
    for row in range(height):
        for column in range(width):
            transmittance = 1.0
            colour = 0.0
            for s in range(samples):
                point = np.array([(row + 0.5) / height, (column + 0.5) / width, (s + 0.5) * step])
                rho = density_at(grid, point)
                if rho < 1e-3:
                    continue
                shadow = density_at(grid, np.clip(point + 0.2 * light / np.sqrt(np.sum(light ** 2)), 0.0, 1.0))
                glow = np.exp(-absorption * 0.2 * shadow)
                colour += transmittance * glow * (1.0 - np.exp(-absorption * rho * step))
                transmittance *= np.exp(-absorption * rho * step)
                if transmittance < 0.05:
                    break
            image[row, column] = colour
    return image.mean()

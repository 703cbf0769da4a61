"""The negative log-likelihood of observations by a Kalman filter."""
import numpy as np


def kalman(x, P, F, H, Q, R, observations):
    """State and covariance are advanced in place."""
    total = 0.0
    n = x.size
    for z in observations:
        x[:] = F @ x
        P[:] = F @ P @ F.T + Q
        innovation = z - H @ x
        S = H @ P @ H.T + R
        K = np.linalg.solve(S, H @ P).T
        x += K @ innovation
        P[:] = (np.eye(n) - K @ H) @ P
        sign, logdet = np.linalg.slogdet(S)
        total += 0.5 * (innovation @ np.linalg.solve(S, innovation) + logdet + z.size * np.log(2.0 * np.pi))
    return total

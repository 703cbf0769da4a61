"""Right-hand sides of ordinary differential equations: hunters and their prey, air pollution (POLLU of the test set of
Mazzia and Magherini, 2008), and a medicine in a body of four compartments with the response to it."""
from __future__ import annotations

import numpy as np


def hunters(du, u, p):
    du[0] = p[0] * u[0] - p[1] * u[0] * u[1]
    du[1] = -p[2] * u[1] + p[3] * u[0] * u[1]


def pollution(du, u, p):
    r = np.empty(25)
    r[0] = p[0] * u[0]
    r[1] = p[1] * u[1] * u[3]
    r[2] = p[2] * u[4] * u[1]
    r[3] = p[3] * u[6]
    r[4] = p[4] * u[6]
    r[5] = p[5] * u[6] * u[5]
    r[6] = p[6] * u[8]
    r[7] = p[7] * u[8] * u[5]
    r[8] = p[8] * u[10] * u[1]
    r[9] = p[9] * u[10] * u[0]
    r[10] = p[10] * u[12]
    r[11] = p[11] * u[9] * u[1]
    r[12] = p[12] * u[13]
    r[13] = p[13] * u[0] * u[5]
    r[14] = p[14] * u[2]
    r[15] = p[15] * u[3]
    r[16] = p[16] * u[3]
    r[17] = p[17] * u[15]
    r[18] = p[18] * u[15]
    r[19] = p[19] * u[16] * u[5]
    r[20] = p[20] * u[18]
    r[21] = p[21] * u[18]
    r[22] = p[22] * u[0] * u[3]
    r[23] = p[23] * u[18] * u[0]
    r[24] = p[24] * u[19]
    du[0] = (-r[0] - r[9] - r[13] - r[22] - r[23] + r[1] + r[2] + r[8] + r[10] + r[11] + r[21] + r[24])
    du[1] = -r[1] - r[2] - r[8] - r[11] + r[0] + r[20]
    du[2] = -r[14] + r[0] + r[16] + r[18] + r[21]
    du[3] = -r[1] - r[15] - r[16] - r[22] + r[14]
    du[4] = -r[2] + 2.0 * r[3] + r[5] + r[6] + r[12] + r[19]
    du[5] = -r[5] - r[7] - r[13] - r[19] + r[2] + 2.0 * r[17]
    du[6] = -r[3] - r[4] - r[5] + r[12]
    du[7] = r[3] + r[4] + r[5] + r[6]
    du[8] = -r[6] - r[7]
    du[9] = -r[11] + r[6] + r[8]
    du[10] = -r[8] - r[9] + r[7] + r[10]
    du[11] = r[8]
    du[12] = -r[10] + r[9]
    du[13] = -r[12] + r[11]
    du[14] = r[13]
    du[15] = -r[17] - r[18] + r[15]
    du[16] = -r[19]
    du[17] = r[19]
    du[18] = -r[20] - r[21] - r[23] + r[22] + r[24]
    du[19] = -r[24] + r[23]


POLLUTION = (
    np.array([0.0, 0.2, 0.0, 0.04, 0.0, 0.0, 0.1, 0.3, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.007, 0.0, 0.0, 0.0]),
    np.array([0.35, 26.6, 1.23e4, 8.6e-4, 8.2e-4, 1.5e4, 1.3e-4, 2.4e4, 1.65e4, 9e3, 0.022, 1.2e4, 1.88, 1.63e4, 4.8e6,
              3.5e-4, 0.0175, 1e8, 4.44e11, 1240.0, 2.1, 5.78, 0.0474, 1780.0, 3.12]))


def medicine(du, u, p):
    """From the depot into the blood and two tissues, cleared by the kidneys and by an enzyme; the response falls."""
    ka, clearance, volume, flow, tissue, flow_2, tissue_2 = p[0], p[1], p[2], p[3], p[4], p[5], p[6]
    made, lost, half, least, most, enzyme = p[7], p[8], p[9], p[10], p[11], p[12]
    blood = u[1] / volume
    du[0] = -ka * u[0]
    du[1] = (ka * u[0] - (clearance + most / (enzyme + blood) + flow + flow_2) * blood + flow * u[2] / tissue
             + flow_2 * u[3] / tissue_2)
    du[2] = flow * (blood - u[2] / tissue)
    du[3] = flow_2 * (blood - u[3] / tissue_2)
    du[4] = made * (1.0 - least * blood / (half + blood)) - lost * u[4]

# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/control/force_observers_test.cpp: the steady gain of a Kalman filter for position, velocity and force
of a slave, from SciPy's solver of the discrete Riccati equation and quadrature of the process noise.

Run in this folder: python3 control_kalman.py > control_kalman.csv
"""

import numpy as np
import scipy
from scipy.integrate import quad_vec
from scipy.linalg import expm, solve_discrete_are

print(f"# control_kalman.py, scipy {scipy.__version__}")
print("mass_kg,damping_N_s_per_m,dt_s,force_walk_N,model_noise_N,position_noise_m,gain_0,gain_1,gain_2")
for mass, damping, dt, walk, model, noise in [
    (0.032, 0.0, 2e-4, 10.0, 1e-3, 3e-6),
    (0.032, 0.5, 2e-4, 100.0, 1e-2, 3e-6),
    (10.0, 1.0, 1e-3, 50.0, 0.1, 1e-5),
    (6.8, 1610.0, 1e-3, 2000.0, 5.0, 1e-6),
]:
    f = np.array([[0, 1, 0], [0, -damping / mass, 1 / mass], [0, 0, 0]])
    density = np.diag([0, (model / mass) ** 2, walk**2])
    a = expm(f * dt)
    q, _ = quad_vec(lambda t: expm(f * t) @ density @ expm(f.T * t), 0, dt, epsrel=1e-13)
    c = np.array([[1.0, 0, 0]])
    # In units in which all states are of like size, for the solver's sake.
    scale = np.diag([1 / noise, 1 / np.sqrt(q[1, 1]), 1 / np.sqrt(q[2, 2])])
    back = np.linalg.inv(scale)
    p = solve_discrete_are((scale @ a @ back).T, (c @ back).T, scale @ q @ scale, np.array([[noise**2]]))
    p = back @ p @ back
    gain = p[:, 0] / (p[0, 0] + noise**2)
    print(f"{mass},{damping},{dt},{walk},{model},{noise}," + ",".join(f"{g:.12e}" for g in gain))

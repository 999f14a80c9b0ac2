# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/signal/predictors_test.cpp: taps of polynomial extrapolation from SciPy's Savitzky-Golay design, and
gains of the Kalman filter of constant velocity or acceleration from its solver of the discrete Riccati equation.

Run in this folder: python3 signal_predictors.py (writes signal_polynomial_predictor.csv and signal_kalman_predictor.csv)
"""

import numpy as np
import scipy
from scipy.linalg import solve_discrete_are
from scipy.signal import savgol_coeffs
from scipy.special import factorial

DT = 2e-4
HORIZON = 0.0036

with open("signal_polynomial_predictor.csv", "w") as out:
    print(f"# signal_predictors.py, scipy {scipy.__version__}", file=out)
    print("samples,degree,lag,tap", file=out)
    for samples, degree in [(1, 0), (5, 0), (2, 1), (9, 1), (16, 2), (56, 2), (9, 3), (128, 3)]:
        # SciPy designs inside the window only; from its newest sample on, the Taylor series is exact for a polynomial.
        steps = HORIZON / DT
        taps = sum(
            savgol_coeffs(samples, degree, deriv=k, pos=samples - 1, use="dot") * steps**k / factorial(k)
            for k in range(degree + 1)
        )
        for lag, tap in enumerate(taps[::-1]):
            print(f"{samples},{degree},{lag},{tap:.15e}", file=out)

with open("signal_kalman_predictor.csv", "w") as out:
    print(f"# signal_predictors.py, scipy {scipy.__version__}", file=out)
    print("order,dt_s,process_noise,measurement_noise,gain_0,gain_1,gain_2", file=out)
    for order, dt, process, measurement in [
        (2, 2e-4, 0.03, 3e-6),
        (2, 1e-3, 1.0, 1.0),
        (2, 1e-3, 1e3, 1e-2),
        (3, 2e-4, 3.0, 3e-6),
        (3, 1e-3, 1e4, 1e-2),
        (3, 1e-3, 1e3, 1e-5),
    ]:
        # In ticks; the integral of the process noise in closed form.
        ratio = process / measurement
        if order == 2:
            a = np.array([[1, 1], [0, 1.0]])
            q = ratio**2 * dt**3 * np.array([[1 / 3, 1 / 2], [1 / 2, 1]])
        else:
            a = np.array([[1, 1, 0.5], [0, 1, 1], [0, 0, 1.0]])
            q = ratio**2 * dt**5 * np.array([[1 / 20, 1 / 8, 1 / 6], [1 / 8, 1 / 3, 1 / 2], [1 / 6, 1 / 2, 1]])
        c = np.eye(order)[:1]
        p = solve_discrete_are(a.T, c.T, q, np.eye(1))
        gain = np.append(p[:, 0] / (p[0, 0] + 1), [0.0] * (3 - order))
        print(f"{order},{dt},{process},{measurement}," + ",".join(f"{g:.12e}" for g in gain), file=out)

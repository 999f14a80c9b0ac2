#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/identification/frequency_response_test.cpp: SciPy's welch, csd, coherence and rfft, and the same by
Octave's pwelch and fft, on one noisy pair of signals at 5 kHz.

Run in this folder, with SciPy, octave and octave-signal: python3 identification_frequency_response.py
It writes identification_frequency_response.csv (a line of the frequency axis per row) and
identification_frequency_response_signals.csv (a sample per row).
"""
import subprocess
import tempfile

import numpy as np
import scipy
from scipy import fft, signal

RATE_HZ = 5000.0
SEGMENT = 128
OVERLAP = 64
SMOOTHING = 9

random = np.random.default_rng(4)
x = 0.3 + signal.lfilter([1.0], [1.0, -0.6], random.standard_normal(900))
y = 1e-4 * signal.lfilter([0.2, 0.1], [1.0, -1.6, 0.9], x) + 2e-5 * random.standard_normal(900) - 3e-4


def boxcar(g):
    half = SMOOTHING // 2
    return np.array([np.nanmean(g[max(0, k - half) : k + half + 1]) for k in range(len(g))])


def scipy_columns():
    settings = {"fs": RATE_HZ, "nperseg": SEGMENT, "noverlap": OVERLAP, "window": "hann"}
    frequency, pxx = signal.welch(x, **settings)
    _, pyy = signal.welch(y, **settings)
    _, pxy = signal.csd(x, y, **settings)
    _, gamma2 = signal.coherence(x, y, **settings)
    h1 = pxy / pxx
    h2 = pyy / pxy.conj()
    halves = [(x[:450], y[:450]), (x[450:], y[450:])]
    ratios = [fft.rfft(b - b.mean(), SEGMENT * 4) / fft.rfft(a - a.mean(), SEGMENT * 4) for a, b in halves]
    ratio = np.mean(ratios, axis=0)
    ratio[0] = np.nan  # the means are removed, so the line at 0 Hz holds rounding only
    etfe = boxcar(ratio)[: len(frequency)]
    return {
        "frequency_Hz": frequency, "scipy_pxx": pxx, "scipy_pyy": pyy,
        "scipy_pxy_re": pxy.real, "scipy_pxy_im": pxy.imag, "scipy_coherence": gamma2,
        "scipy_h1_re": h1.real, "scipy_h1_im": h1.imag, "scipy_h2_re": h2.real, "scipy_h2_im": h2.imag,
        "scipy_etfe_re": etfe.real, "scipy_etfe_im": etfe.imag,
    }


OCTAVE = """
pkg load signal
s = csvread("{folder}/signals.csv"); x = s(:, 1); y = s(:, 2);
w = hann({segment}, "periodic"); options = {{w, 0.5, {segment}, {rate}, "onesided", "mean"}};
[pxx, f] = pwelch(x, options{{:}});
pyy = pwelch(y, options{{:}});
h1 = pwelch(x, y, options{{:}}, "trans");
gamma2 = pwelch(x, y, options{{:}}, "coher");
halves = {{1:450, 451:900}};
ratio = 0;
for h = 1:2
  a = x(halves{{h}}); b = y(halves{{h}});
  ratio += fft(b - mean(b), {segment} * 4) ./ fft(a - mean(a), {segment} * 4) / 2;
end
lines = {segment} * 2 + 1;
etfe = zeros({segment} / 2 + 1, 1);
for k = 1:rows(etfe)
  etfe(k) = mean(ratio(max(2, k - {half}):min(lines, k + {half})));
end
dlmwrite("{folder}/result.csv", [pxx, pyy, real(h1), imag(h1), gamma2, real(etfe), imag(etfe)], "precision", "%.17g");
disp(["octave " version ", signal " pkg("list", "signal"){{1}}.version]);
"""


def octave_columns():
    with tempfile.TemporaryDirectory() as folder:
        np.savetxt(f"{folder}/signals.csv", np.column_stack([x, y]), fmt="%.17g", delimiter=",")
        script = OCTAVE.format(folder=folder, segment=SEGMENT, rate=RATE_HZ, half=SMOOTHING // 2)
        run = ["octave-cli", "--quiet", "--eval", script]
        versions = subprocess.run(run, check=True, capture_output=True, text=True).stdout.strip().splitlines()[-1]
        table = np.loadtxt(f"{folder}/result.csv", delimiter=",")
    names = ["pxx", "pyy", "h1_re", "h1_im", "coherence", "etfe_re", "etfe_im"]
    return versions, {f"octave_{name}": column for name, column in zip(names, table.T)}


def write(name, versions, columns):
    with open(name, "w") as file:
        print(f"# identification_frequency_response.py, {versions}", file=file)
        print(",".join(columns), file=file)
        for row in zip(*columns.values()):
            print(",".join(f"{value:.17g}" for value in row), file=file)


octave_versions, octave = octave_columns()
VERSIONS = f"scipy {scipy.__version__}; {octave_versions}"
write("identification_frequency_response.csv", VERSIONS, scipy_columns() | octave)
write("identification_frequency_response_signals.csv", VERSIONS, {"input": x, "output": y})

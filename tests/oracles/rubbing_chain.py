# SPDX-License-Identifier: Apache-2.0
"""Three masses on a line, two of which rub, under a force that is held from sample to sample: a part of the oracles that
have Coulomb friction in them.

Between two changes of mode (each rubbing mass slides either way or sticks) the motion is smooth and SciPy's DOP853
integrates it; the changes are located as events. No time stepping scheme for friction is involved. The linkage may be
hysteretic: then its Bouc-Wen equation is integrated along as a seventh state.
"""
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

MASS = np.array([0.0075, 0.01075, 0.014])
FRICTION = np.array([0.01, 0.0144])
CABLE, CABLE_DAMPING = 39500.0, 3.6
LINKAGE, LINKAGE_DAMPING = 3950.0, 0.02
HAND, HAND_DAMPING = 40.0, 23.0


class BoucWen:
    """Force (1 - h) K0 delta + h K0 z of a deflection, dz/dt = v - (|v| z + v |z|) / (2 d)."""

    def __init__(self, average, lost_share, slip, amplitude):
        tip = brentq(lambda z: z - slip * (1 - np.exp(-(2 * amplitude - z) / slip)), 0.0, 2 * amplitude)
        initial = average / (1 - lost_share + lost_share * tip / amplitude)
        self.sustained, self.hysteretic, self.slip = (1 - lost_share) * initial, lost_share * initial, slip

    def force(self, deflection, z):
        return self.sustained * deflection + self.hysteretic * z

    def rate(self, v, z):
        return v - (abs(v) * z + v * abs(z)) / (2 * self.slip)


def pull(y, force, quintic, hysteresis=None):
    """What acts on the three masses, friction left out."""
    cable = CABLE * (y[0] - y[1]) + CABLE_DAMPING * (y[3] - y[4])
    spring = LINKAGE * (y[1] - y[2]) if hysteresis is None else hysteresis.force(y[1] - y[2], y[6])
    linkage = spring + LINKAGE_DAMPING * (y[4] - y[5])
    hand = HAND * y[2] + quintic * y[2] ** 5 + HAND_DAMPING * y[5]
    return np.array([force - cable, cable - linkage, linkage - hand])


def run(forces, sample_time, quintic=0.0, least_share=-1.0, most_share=1.0, offset=0.0, hysteresis=None, first_step=None):
    """States at the samples, from rest. Friction lies between its shares and stops the velocity plus `offset`. A mass may
    slip for microseconds; a short `first_step` after each change of mode sees that."""
    least, most = least_share * FRICTION, most_share * FRICTION
    states = np.zeros((len(forces), 6))
    y = np.zeros(6 if hysteresis is None else 7)
    sliding = [0, 0]
    if offset != 0.0:
        sliding = [int(np.sign(offset))] * 2

    def held(i, force, y):
        """0 where friction can hold mass i, else the way it will slide."""
        needed = -pull(y, force, quintic, hysteresis)[i]
        return 1 if needed < least[i] else -1 if needed > most[i] else 0

    for n, force in enumerate(forces):
        states[n] = y[:6]
        for i in range(2):
            if sliding[i] == 0:
                sliding[i] = held(i, force, y)
        t = 0.0
        while t < sample_time:

            def change(_, y, way=tuple(sliding)):
                total = pull(y, force, quintic, hysteresis)
                for i in range(2):
                    total[i] = 0.0 if way[i] == 0 else total[i] + (least[i] if way[i] > 0 else most[i])
                slip = [] if hysteresis is None else [hysteresis.rate(y[4] - y[5], y[6])]
                return np.concatenate([y[3:6], total / MASS, slip])

            events = []
            for i in range(2):
                if sliding[i] == 0:

                    def event(_, y, i=i):
                        needed = -pull(y, force, quintic, hysteresis)[i]
                        return min(needed - least[i], most[i] - needed)

                else:

                    def event(_, y, i=i, way=sliding[i]):
                        return way * (y[3 + i] + offset)

                event.terminal, event.direction = True, -1
                events.append(event)
            begin = None if first_step is None else min(first_step, sample_time - t)
            piece = solve_ivp(
                change, (t, sample_time), y, "DOP853", events=events, rtol=1e-9, atol=1e-13, first_step=begin
            )
            t, y = piece.t[-1], piece.y[:, -1]
            for i in range(2):
                if len(piece.t_events[i]) == 0:
                    continue
                if sliding[i] != 0:
                    y[3 + i] = -offset
                    sliding[i] = held(i, force, y)
                else:
                    needed = -pull(y, force, quintic, hysteresis)[i]
                    sliding[i] = 1 if needed < 0.5 * (least[i] + most[i]) else -1
    return states

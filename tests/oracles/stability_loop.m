% Oracle of tests/stability/loop_test.cpp: the loop of induced master motion built with octave-control from the numbers
% of Table I, its responses, margins and poles. Delays are powers of z.
%
% Run in this folder: octave --no-gui stability_loop.m > stability_loop.csv
1;
pkg load control

function device = chain(tip, amplifier_Hz, sensor_Hz, linkage_scale, mass_scale)
  % [motor command] to [motor position; sensor] of motor, cable, drum, linkage and a tip held by k and b.
  M = mass_scale * diag([0.0075, 0.01075, 0.014]);
  join = @(c, l, t) [c, -c, 0; -c, c + l, -l; 0, -l, l + t];
  K = join(39500, 3950 * linkage_scale, tip(1));
  B = join(3.6, 0.02, tip(2));
  mechanics = ss([zeros(3), eye(3); -M \ K, -M \ B], [zeros(3, 1); M \ [1; 0; 0]], ...
                 [1, 0, 0, 0, 0, 0; 0, 0, tip(1), 0, 0, tip(2)], zeros(2, 1));
  if amplifier_Hz > 0
    w = 2 * pi * amplifier_Hz;
    mechanics = mechanics * ss(-w, w, 1, 0);
    c = 2 * pi * sensor_Hz;
    sensor = ss(c * [0, 1; -1, -sqrt(2)], [0; c], [1, 0], 0);
    mechanics = append(ss(1), sensor) * mechanics;
  end
  device = mechanics;
end

function m = two_actuators(tip, amplifier_Hz, actuator_Hz)
  % [motor command, command of the actuator on the handle] to [motor position], of one mechanism: two that are equal
  % would leave modes in the loop that no force reaches.
  M = diag([0.0075, 0.01075, 0.014]);
  K = [39500, -39500, 0; -39500, 39500 + 3950, -3950; 0, -3950, 3950 + tip(1)];
  B = [3.6, -3.6, 0; -3.6, 3.6 + 0.02, -0.02; 0, -0.02, 0.02 + tip(2)];
  o = 2 * pi * [amplifier_Hz, actuator_Hz];
  m = ss([zeros(3), eye(3); -M \ K, -M \ B], [zeros(3, 2); M \ [1, 0; 0, 0; 0, 1]], [1, 0, 0, 0, 0, 0], [0, 0]) * ...
      ss(-diag(o), diag(o), eye(2), zeros(2));
end

function c = compensation(mass, band_Hz, T)
  % Zeros on the mode of motor and drum on the linkage, the handle in the hand; well damped poles at the band's edge.
  M = mass * diag([0.0075 + 0.01075, 0.014]);
  K = [3950, -3950; -3950, 3950 + 40];
  B = [0.02, -0.02; -0.02, 0.02 + 23];
  s = eig([zeros(2), eye(2); -M \ K, -M \ B]);
  s = s(imag(s) > 0);
  zero = exp(s(1) * T);
  p = exp(2 * pi * band_Hz * (-1 + 1i) / sqrt(2) * T);
  top = [1, -2 * real(zero), abs(zero)^2];
  bottom = [1, -2 * real(p), abs(p)^2];
  c = ss(tf(sum(bottom) / sum(top) * top, bottom, T));
end

function d = hold(p, T, late)
  % Zero-order hold whose input changes `late` after the sample.
  [a, b, c] = ssdata(p);
  early = c2d(ss(a, b, c, 0 * c * b), late);
  rest = c2d(ss(a, b, c, 0 * c * b), T - late);
  [n, m] = size(b);
  d = ss([rest.a * early.a, rest.a * early.b; zeros(m, n + m)], [rest.b; eye(m)], [c, zeros(rows(c), m)], ...
         zeros(rows(c), m), T);
end

function f = low_pass(Hz, T)
  k = tan(pi * Hz * T);
  f = ss(tf(k^2 * [1, 2, 1], [1 + sqrt(2) * k + k^2, 2 * (k^2 - 1), 1 - sqrt(2) * k + k^2], T));
end

function y = at(L, w)
  y = squeeze(freqresp(L, w));
end

T = 2e-4;
late = 20e-6;
z = tf([1, 0], 1, T);
frequencies_Hz = [0.5, 20, 74, 200, 900];
printf("# stability_loop.m, octave %s, control %s\n", version(), pkg("list", "control"){1}.version);
printf("delay_ticks,cancellation,mass,filter_Hz,mu,crossover_Hz,compensation_Hz,gain_factor,gain_Hz,phase_rad,phase_Hz,delay_s,modulus,disk,pole_re,pole_im,pole2_re,pole2_im");
printf(",re%d,im%d", [1:5; 1:5]);
printf("\n");
for setting = [0, 0, 1, 0, 0.36, 0, 0; 12, 0, 1, 0, 0.32, 0, 0; 0, 1, 1.2, 0, 1.6, 0, 0; 12, 1, 1.2, 0, 0.85, 0, 0; ...
               0, 1, 0.8, 120, 1.7, 0, 0; 37, 1, 0.9, 0, 2.3, 0, 0; 0, 0, 1, 0, 2.7, 0, 200; ...
               0, 0, 1, 0, 1.2, 60, 0;                7, 1, 0.9, 0, 1.2, 40, 150]'
  [d, cancels, mass, filter_Hz, mu, crossover_Hz, compensation_Hz] = num2cell(setting){:};
  if crossover_Hz > 0
    induced = hold(two_actuators([40, 23], 5000, 1000), T, late);
  else
    induced = hold(chain([40, 23], 5000, 1000, 1, 1)(1, 1), T, late);
  end
  actuators = columns(induced);
  if cancels
    model = c2d(chain([40, 23], 0, 0, 1, mass)(1, 1), T);
    induced = parallel(induced, -model * ss(eye(1, actuators), "tsam", T));
  end
  if compensation_Hz > 0
    before = compensation(mass, compensation_Hz, T);
    if actuators == 2, before = append(before, ss(1, "tsam", T)); end
    induced = induced * before;
  end
  if crossover_Hz > 0
    % One filter for both parts, or its poles would be there twice.
    below = low_pass(crossover_Hz, T);
    split = ss(below.a, below.b, [below.c; -below.c], [below.d; 1 - below.d], T);
    induced = induced * split;
  end
  if filter_Hz > 0
    induced = induced * low_pass(filter_Hz, T);
  end
  x = pi * 300 * T;
  m = 4 * x^2 * sin(x)^2 / (2 * sin(x)^2 - x^2);
  alpha = m / (sqrt(m + m^2 / 4) + m / 2);
  rate = ss(tf(alpha / T * [1, -1], [1, alpha - 1], T));
  servo = ss(100, "tsam", T) + 0.65 * rate;
  plant = hold(chain([40000, 3], 5000, 1000, 1, 1), T, late);
  servoed = feedback(plant * servo, [1, 0]);
  slave = servoed(2, 1);
  delay = ss(zeros(d + 1), zeros(d + 1, 1), zeros(1, d + 1), 0, T);
  delay.a = diag(ones(d, 1), -1);
  delay.b = [1; zeros(d, 1)];
  delay.c = [zeros(1, d), 1];
  L = mu * delay * slave * induced;
  w = 2 * pi * logspace(log10(0.05), log10(2499), 40000);
  h = at(L, w);
  % Crossings on a fine grid, each then refined.
  best = [Inf, 0];
  for i = find(diff(sign(imag(h(:)'))) != 0)
    wc = fzero(@(v) imag(at(L, v)), [w(i), w(i + 1)], optimset("TolX", 1e-13));
    g = at(L, wc);
    if real(g) < 0 && -1 / real(g) < best(1), best = [-1 / real(g), wc]; end
  end
  phase = [Inf, 0];
  lag = Inf;
  for i = find(diff(abs(h(:)') > 1) != 0)
    wc = fzero(@(v) abs(at(L, v)) - 1, [w(i), w(i + 1)], optimset("TolX", 1e-13));
    p = arg(-at(L, wc));
    if abs(p) < abs(phase(1)), phase = [p, wc]; end
    lag = min(lag, mod(p, 2 * pi) / wc);
  end
  function v = least(value, L, w, h)
    [~, i] = min(value(h));
    [~, v] = fminbnd(@(u) value(at(L, u)), w(max(i - 1, 1)), w(min(i + 1, end)), optimset("TolX", 1e-10));
  end
  modulus = least(@(g) abs(1 + g), L, w, h);
  disk = least(@(g) 2 * abs((1 + g) ./ (1 - g)), L, w, h);
  p = pole(feedback(L, 1));
  % Device and model share the slow mode of the hand, a double pole that no solver finds well: those that oscillate.
  p = p(arg(p) > 2 * pi * 20 * T);
  [~, order] = sort(abs(p), "descend");
  p = p(order);
  printf("%d,%d,%g,%g,%g,%g,%g", d, cancels, mass, filter_Hz, mu, crossover_Hz, compensation_Hz);
  printf(",%.15g", best(1), best(2) / (2 * pi), phase(1), phase(2) / (2 * pi), lag, modulus, disk, ...
         real(p(1)), imag(p(1)), real(p(2)), imag(p(2)));
  g = at(L, 2 * pi * frequencies_Hz)(:).';
  printf(",%.15g", [real(g); imag(g)]);
  printf("\n");
end

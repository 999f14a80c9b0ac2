% octave read_exports.m FOLDER: Octave loads the MATLAB export of the sample log in the one line that the documentation
% shows, and names, units and values are those of ../sample.hpp.
log = load([argv(){1} '/log.mat']);
for topic = {{'run_1_sample', (0:19999)'}, {'run_2_sample', (0:2:19998)'}}
  one = log.(topic{1}{1});
  k = topic{1}{2};
  assert(one.time_s, 0.001 * k);
  assert(one.touched, double(mod(k, 3) == 0));
  assert(one.force_N, 0.5 * k - 100);
  assert(one.count, -k);
  assert(one.units.force_N, 'N');
  assert(one.units.time_s, 's');
  assert(isempty(one.units.count));
end
assert(log.about.configuration, sprintf("[servo]\nrate_Hz = 5000\n"));
disp('equal names, units and values');

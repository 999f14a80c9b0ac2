% octave read_hdf5.m FOLDER: Octave loads the HDF5 export of the sample log in one line, and names and values are those of
% ../sample.hpp. Units are attributes of the data sets, which Octave's `load` leaves alone; the MATLAB export has them.
log = load([argv(){1} '/log.h5']);
for topic = {{'run_1_sample', 0:19999}, {'run_2_sample', 0:2:19998}}
  one = log.(topic{1}{1});
  k = topic{1}{2};
  assert(one.time_s, 0.001 * k);
  assert(one.touched, double(mod(k, 3) == 0));
  assert(one.force_N, 0.5 * k - 100);
  assert(one.count, -k);
end
assert(log.about.configuration, sprintf("[servo]\nrate_Hz = 5000\n"));
disp('equal names and values');

% The function wems against what is known of the shipped device; the first failure ends with status 1.
folder = tempname ();
mkdir (folder);
remove_folder = onCleanup (@() system (['rm -r ' folder]));
cd (folder);
shipped = getenv ('WEMS_MODELS');
model = fullfile (shipped, 'smallsat_wems.toml');

% Modes and a run: a struct, and a recording in SI units.
modes = wems ('simulate', model, 'modes', true);
assert (modes.version, 2);
assert (modes.modes(1).frequency, 11.157, 0.01);
run = wems ('simulate', model, 'sweep', '8:40', 'rate', 60, 'force', 'z=40', 'noise', 'displacement=1e-6', ...
            'sample_rate', 500, 'output', 'it''s a run.csv');
assert (all (cellfun (@isempty, {run.stops.contacts})));
assert (size (run.recording.values), [numel(run.recording.time), numel(run.recording.names)]);
assert (diff (run.recording.time(1:2)), 0.002, 1e-12);
z = run.recording.values(:, strcmp (run.recording.names, 'mobile.1.z'));
fixed = run.recording.values(:, strcmp (run.recording.names, 'fixed.1.z'));
largest = run.relative_displacements(strcmp ({run.relative_displacements.name}, '1.z')).largest;
assert (max (abs (z - fixed)), abs (largest), 0.02 * abs (largest));  % samples and noise beside the integrator's steps
again = wems ('simulate', model, 'sweep', '8:40', 'rate', 60, 'force', 'z=40', 'noise', 'displacement=1e-6', ...
              'sample_rate', 500);
assert (again.recording.values, run.recording.values);

% Any format that the programs read: here MATLAB's own, in millimetres.
data.Time = run.recording.time;
data.Z = 1e3 * z;
save ('-v7', 'shaker.mat', '-struct', 'data');
map = fopen ('map.toml', 'w');
fprintf (map, '[columns]\nTime = { channel = "time", unit = "s" }\nZ = { channel = "mobile.1.z", unit = "mm" }\n');
fclose (map);
read = wems ('read', 'shaker.mat', 'columns', 'map.toml');
assert (read.recording.names, {'mobile.1.z'});
assert (read.recording.units, {'mm'});
assert (read.recording.values, data.Z, 1e-8 * max (abs (data.Z)));  % nine digits of the table in between

% Identification of one element on a test machine, 5e4 N/m and 40 N s/m, 2 Hz, 1 mm.
t = (0:0.001:2)';
w = 2 * pi * 2;
element = [t, 1e-3 * sin(w * t), 5e4 * 1e-3 * sin(w * t) + 40 * 1e-3 * w * cos(w * t)];
table = fopen ('element.csv', 'w');
fprintf (table, 'time [s],relative.1.z [m],force.1.z [N]\n');
fprintf (table, '%.4f,%.10e,%.10e\n', element');
fclose (table);
toml = fopen ('element.toml', 'w');
fprintf (toml, '[body]\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\n[[connection]]\nname = "1"\nposition = [0.0, 0.0, 0.0]\n');
fprintf (toml, '[connection.z]\nstiffness = 4e4\ndamping = 10.0\n');
fclose (toml);
fit = wems ('fit', 'element.csv', 'model', 'element.toml', 'output', 'fitted.toml');
value = @(name) fit.parameters(strcmp ({fit.parameters.name}, name)).value;
assert (value ('1.z.stiffness'), 5e4, 1e-3 * 5e4);
assert (value ('1.z.damping'), 40, 0.01 * 40);
assert (exist ('fitted.toml', 'file'), 2);
assert (fit.exit_status, 0);
failed = wems ('rigidity', 'it''s a run.csv', 'model', model, 'limit', 1e-9);
assert (failed.exit_status, 1);

% Bad input: the program's line as an error.
try
  wems ('fit', 'nothing.csv', 'model', model);
  error ('no error');
catch problem
  assert (problem.identifier, 'wems:input');
  assert (~isempty (strfind (problem.message, 'nothing.csv')));
end
try
  wems ('fit', 'it''s a run.csv', 'model');
  error ('no error');
catch problem
  assert (problem.identifier, 'wems:input');
end

function result = wems (command, varargin)
% WEMS  Call the programs of WEMS from Octave or MATLAB; what they find comes back as a struct.
%
%   result = wems ('fit', 'run.csv', 'model', 'believed.toml')
%   result = wems ('diagnose', {'a.mat', 'b.mat'}, 'model', 'believed.toml', 'validate', 'c.mat', ...
%                  'columns', 'map.toml', 'output', 'extended.toml')
%   run    = wems ('simulate', 'mount.toml', 'sweep', '5:50', 'rate', 4, 'force', 'z=200')
%   modes  = wems ('simulate', 'mount.toml', 'modes', true)
%   run    = wems ('read', 'shaker.mat', 'columns', 'map.toml')
%
% First the command, then its files (a name or a cell array of names), then options of the program in pairs of name and
% value: a number, a text, true for an option without a value, or a cell array for several values. An underscore in a
% name stands for a hyphen. `wems-identify fit --help` lists the options of fit.
%
% The result has the fields of the JSON that --json writes ("wems-identify schema fit"), and exit_status: 0, or 1 where
% a limit or a verdict that was asked for failed. Bad input is an error with the identifier wems:input and the
% program's one line.
%
% A recording, from 'read' or a run of 'simulate', is result.recording: time (s, column), names and units (cell arrays),
% values (a column for each name, in its unit). 'read' reads every format that the programs read.
%
% The programs are wems-identify and wems-simulate of the path, or what the environment variables WEMS_IDENTIFY and
% WEMS_SIMULATE name.

  if nargin < 1 || ~ischar (command)
    error ('wems:input', 'wems: the first argument is a command, such as ''fit''');
  end
  files = {};
  pairs = varargin;
  if ~isempty (pairs) && (mod (numel (pairs), 2) == 1 || iscell (pairs{1}))
    files = cellstr (pairs{1});
    pairs(1) = [];
  end
  if mod (numel (pairs), 2) == 1
    error ('wems:input', 'wems: the option %s has no value', pairs{end});
  end
  words = list_words (pairs);
  json = [tempname() '.json'];
  remove_json = onCleanup (@() remove (json));

  if strcmp (command, 'read')
    csv = [tempname() '.csv'];
    remove_csv = onCleanup (@() remove (csv));
    result = call ('identify', [{'convert'}, files, {csv}, words], json);
    result.recording = read_csv (csv);
  elseif ~strcmp (command, 'simulate')
    result = call ('identify', [{command}, files, words], json);
  else
    names = pairs(1:2:end);
    is_run = ~any (ismember (names, {'modes', 'frf', 'response'}));
    named = find (strcmp (names, 'output'));
    if ~is_run || ~isempty (named)
      result = call ('simulate', [files, words], json);
      csv = '';
      if is_run
        csv = pairs{2 * named(1)};
      end
    else
      csv = [tempname() '.csv'];
      remove_csv = onCleanup (@() remove (csv));
      result = call ('simulate', [files, words, {'--output', csv}], json);
    end
    if numel (csv) > 4 && strcmp (csv(end-3:end), '.csv')
      result.recording = read_csv (csv);
    end
  end
end

function words = list_words (pairs)
  words = {};
  for k = 1:2:numel (pairs)
    value = pairs{k+1};
    option = ['--' strrep(pairs{k}, '_', '-')];
    if islogical (value)
      if value
        words{end+1} = option;
      end
      continue;
    end
    if ~iscell (value)
      value = {value};
    end
    for j = 1:numel (value)
      if isnumeric (value{j})
        value{j} = sprintf ('%.17g', value{j});
      end
      words = [words, {option, value{j}}];
    end
  end
end

function result = call (program, words, json)
  path = getenv (['WEMS_' upper(program)]);
  if isempty (path)
    path = ['wems-' program];
  end
  words = [{path}, words, {'--json', json, '--quiet'}];
  line = '';
  for k = 1:numel (words)
    line = [line '''' strrep(words{k}, '''', '''\''''') ''' '];
  end
  if exist ('OCTAVE_VERSION', 'builtin') == 0
    line = ['env -u LD_LIBRARY_PATH ' line];  % MATLAB's own libraries are not those of the programs
  end
  [status, output] = system ([line '2>&1']);
  if status > 1
    error ('wems:input', '%s', strtrim (output));
  end
  result = align (jsondecode (fileread (json)));
  result.exit_status = status;
end

function value = align (value)
  % Lists whose entries have not all the same fields become arrays of structs too; what an entry lacks is empty.
  if isstruct (value)
    names = fieldnames (value);
    for k = 1:numel (value)
      for j = 1:numel (names)
        value(k).(names{j}) = align (value(k).(names{j}));
      end
    end
  elseif iscell (value)
    value = cellfun (@align, value, 'UniformOutput', false);
    if isempty (value) || ~all (cellfun (@(entry) isstruct (entry) && isscalar (entry), value))
      return;
    end
    names = {};
    for k = 1:numel (value)
      names = union (names, fieldnames (value{k}));
    end
    for k = 1:numel (value)
      for j = 1:numel (names)
        if ~isfield (value{k}, names{j})
          value{k}.(names{j}) = [];
        end
      end
      value{k} = orderfields (value{k});
    end
    value = reshape ([value{:}], [], 1);
  end
end

function recording = read_csv (file)
  stream = fopen (file, 'r');
  header = 0;
  line = fgetl (stream);
  while line(1) == '#'
    header = header + 1;
    line = fgetl (stream);
  end
  fclose (stream);
  columns = strsplit (line, ',');
  names = cell (size (columns));
  units = names;
  for k = 1:numel (columns)
    parts = regexp (columns{k}, '^(.*) \[(.*)\]$', 'tokens', 'once');
    names{k} = parts{1};
    units{k} = parts{2};
  end
  values = dlmread (file, ',', header + 1, 0);
  recording = struct ('time', values(:, 1), 'names', {names(2:end)}, 'units', {units(2:end)}, 'values', values(:, 2:end));
end

function remove (file)
  if exist (file, 'file')
    delete (file);
  end
end

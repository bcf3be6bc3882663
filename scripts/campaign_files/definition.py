"""What a campaign file says: its cases, what is drawn for each of them, and the commands that each runs.

A case is a draw of one combination of model, recording, excitation and grid values. Draws are numbered from 0, and case i is
combination i mod n of draw i div n: more draws add cases and change none. Each quantity of a draw has a random stream of
its own, seeded with the campaign's seed, the draw and its name, so that another quantity changes none of the others.
"""
import glob
import hashlib
import itertools
import math
import os
import random
import re
import shlex
import tomllib


class CampaignError(Exception):
    """One line: file, key, what is wrong, what is accepted."""


TOP = {"name": str, "seed": int, "cases": int, "batch": int, "models": list, "each": str, "keep": list}
TABLES = {
    "parameter": {"name": (str, list), "shared": bool, "relative": bool, "added": bool},
    "variable": {"name": str},
    "excitation": {"name": str, "options": str},
    "command": {"run": str, "accept": list, "seconds": (int, float)},
    "result": {"column": str, "file": str, "key": str, "text": bool},
    "finally": {"run": str},
}
REQUIRED = {"parameter": ["name"], "variable": ["name"], "excitation": ["name", "options"], "command": ["run"],
            "result": ["column", "file", "key"], "finally": ["run"]}
DISTRIBUTIONS = {"uniform": 2, "log_uniform": 2, "normal": 2, "tolerance": 0, "values": None, "grid": None}  # count of numbers


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def check_distribution(entry, where):
    """CampaignError if an entry has not one distribution, or its numbers make none."""
    found = [d for d in DISTRIBUTIONS if d in entry]
    if len(found) != 1:
        raise CampaignError(f"{where}: {len(found)} distributions (accepted: one of {', '.join(DISTRIBUTIONS)})")
    kind, value = found[0], entry[found[0]]
    if kind == "tolerance":
        if not is_number(value) or value < 0:
            raise CampaignError(f"{where}.tolerance: {value!r} (accepted: a number from 0 on, twice the standard deviation)")
        return
    count = DISTRIBUTIONS[kind]
    if not isinstance(value, list) or not value or not all(map(is_number, value)) or (count and len(value) != count):
        raise CampaignError(f"{where}.{kind}: {value!r} (accepted: a list of {count or 'some'} numbers)")
    if kind in ("uniform", "log_uniform") and not value[0] < value[1]:
        raise CampaignError(f"{where}.{kind}: {value!r} (accepted: lower limit, then a higher one)")
    if kind == "log_uniform" and value[0] <= 0:
        raise CampaignError(f"{where}.log_uniform: {value!r} (accepted: limits above zero)")
    if kind == "normal" and value[1] < 0:
        raise CampaignError(f"{where}.normal: {value!r} (accepted: mean, then a standard deviation from 0 on)")


def kind_of(entry):
    return next(d for d in DISTRIBUTIONS if d in entry)


def check_table(text, file):
    """Refuses what a campaign file does not have, by name."""
    known = {**TOP, **{name: list for name in TABLES}}
    for key, value in text.items():
        if key not in known:
            raise CampaignError(f"{file}: {key}: unknown key (accepted: {', '.join(known)})")
        if not isinstance(value, known[key]) or isinstance(value, bool):
            raise CampaignError(f"{file}: {key}: {value!r} (accepted: {known[key].__name__})")
    for name, keys in TABLES.items():
        drawn = name in ("parameter", "variable")
        accepted = {**keys, **({d: object for d in DISTRIBUTIONS} if drawn else {})}
        for number, entry in enumerate(text.get(name, []), 1):
            where = f"{file}: {name} {number}"
            if not isinstance(entry, dict):
                raise CampaignError(f"{where}: {entry!r} (accepted: a table [[{name}]])")
            for key, value in entry.items():
                if key not in accepted:
                    raise CampaignError(f"{where}: {key}: unknown key (accepted: {', '.join(accepted)})")
                if accepted[key] is not object and not isinstance(value, accepted[key]):
                    raise CampaignError(f"{where}: {key}: {value!r} has the wrong type")
            for key in REQUIRED[name]:
                if key not in entry:
                    raise CampaignError(f"{where}: {key} is missing")
            if drawn:
                check_distribution(entry, where)
    for key in ("cases", "batch"):
        if text.get(key, 1) < 1:
            raise CampaignError(f"{file}: {key}: {text[key]} (accepted: a number from 1 on)")
    if not text.get("command"):
        raise CampaignError(f"{file}: no [[command]] (accepted: at least one)")


def list_connections(model):
    with open(model, "rb") as file:
        return [connection["name"] for connection in tomllib.load(file).get("connection", [])]


def expand_names(names, model):
    """The parameters' names with `*` standing for each connection of the model."""
    connections = None
    expanded = []
    for name in [names] if isinstance(names, str) else names:
        if name.startswith("*."):
            connections = connections or list_connections(model)
            expanded += [connection + name[1:] for connection in connections]
        else:
            expanded.append(name)
    return expanded


class Campaign:
    """A campaign file, checked. `text` is its content, paths in it relative to `base`."""

    def __init__(self, text, base, file="campaign"):
        check_table(text, file)
        self.text, self.base, self.file = text, os.path.abspath(base), file
        self.seed, self.draws = text.get("seed", 0), text.get("cases", 1)
        self.models = [self.resolve(m) for m in text.get("models", [])]
        for model in self.models:
            if not os.path.isfile(model):
                raise CampaignError(f"{file}: models: there is no file {model}")
        self.each = sorted(glob.glob(self.resolve(text["each"]))) if "each" in text else []
        if "each" in text and not self.each:
            raise CampaignError(f"{file}: each: no file or folder fits {text['each']}")
        if text.get("parameter") and not self.models:
            raise CampaignError(f"{file}: parameters without models (accepted: models = [\"mount.toml\"])")
        self.excitations = text.get("excitation", [])
        self.commands, self.results, self.keep = text["command"], text.get("result", []), text.get("keep", [])
        self.grids = [e for e in text.get("parameter", []) + text.get("variable", []) if kind_of(e) == "grid"]
        self.combinations = list(itertools.product(self.models or [None], self.each or [None], self.excitations or [None],
                                                   *[e["grid"] for e in self.grids]))
        self.count = self.draws * len(self.combinations)
        self.batch = text.get("batch") or max(1, min(100, math.ceil(self.count / 32)))
        self.make_case(0)
        self.make_last_commands({})  # an unknown name in braces is said before anything runs

    def resolve(self, path):
        return os.path.normpath(os.path.join(self.base, path))

    def batch_count(self):
        return math.ceil(self.count / self.batch)

    def identity(self):
        """What must not change while cases of a folder are done: all but their number."""
        digest = hashlib.sha256()
        digest.update(repr(sorted((k, v) for k, v in self.text.items() if k not in ("cases", "batch"))).encode())
        for model in self.models:
            with open(model, "rb") as file:
                digest.update(file.read())
        return digest.hexdigest()

    def draw(self, entry, name, number):
        """(operation, value): what a draw makes of a parameter or variable."""
        stream = random.Random(f"{self.seed}/{number}/{name}")
        kind = kind_of(entry)
        value = entry.get(kind)
        operation = "*=" if entry.get("relative") else "+=" if entry.get("added") else "="
        if kind == "uniform":
            return operation, value[0] + (value[1] - value[0]) * stream.random()
        if kind == "log_uniform":
            return operation, math.exp(math.log(value[0]) + (math.log(value[1]) - math.log(value[0])) * stream.random())
        if kind == "normal":
            return operation, stream.normalvariate(value[0], value[1])
        if kind == "tolerance":  # two standard deviations, of the model's own value unless added to it
            return ("+=", stream.normalvariate(0, value / 2)) if operation == "+=" else ("*=", stream.normalvariate(1, value / 2))
        return operation, stream.choice(value)

    def make_case(self, index):
        """A case: what is written into its row, what its parameters become, and its commands."""
        number, combination = divmod(index, len(self.combinations))
        model, each, excitation, *grid = self.combinations[combination]
        grid = {id(entry): value for entry, value in zip(self.grids, grid)}
        row = {"case": index, "draw": number}
        words = {"seed": random.Random(f"{self.seed}/{index}").randrange(1, 10**9), "index": index}
        if model:
            row["model"] = os.path.splitext(os.path.basename(model))[0]
            words["believed"] = model
        if each:
            row["each"] = os.path.basename(each)
            words["each"] = each
        changes = []
        for entry in self.text.get("parameter", []):
            names = expand_names(entry["name"], model)
            common = self.draw(entry, " ".join(names), number) if entry.get("shared") else None
            for name in names:
                operation, value = common or self.draw(entry, name, number)
                changes.append(f"{name}{operation}{grid.get(id(entry), value)!r}")
        for entry in self.text.get("variable", []):
            row[entry["name"]] = words[entry["name"]] = grid.get(id(entry), self.draw(entry, entry["name"], number)[1])
        if model:
            words["model"] = "model.toml" if changes else model
        if excitation:
            row["excitation"] = excitation["name"]
            words["excitation"] = fill(excitation["options"], words, f"{self.file}: excitation {excitation['name']}")
        commands = [shlex.split(fill(c["run"], words, f"{self.file}: command {n}")) for n, c in enumerate(self.commands, 1)]
        return {"row": row, "model": model, "changes": changes, "commands": commands}

    def make_last_commands(self, kept):
        """Those of [[finally]]; `kept` has the files that were kept, by name and in the order of the cases."""
        commands = []
        for number, entry in enumerate(self.text.get("finally", []), 1):
            words = {"believed": self.models[0]} if self.models else {}
            command = []
            for word in shlex.split(entry["run"]):
                kept_name = re.fullmatch(r"\{all:([^}]+)\}", word)
                if kept_name and kept_name[1] not in self.keep:
                    raise CampaignError(f"{self.file}: finally {number}: {word} is not kept (accepted: one of keep)")
                command += kept.get(kept_name[1], []) if kept_name else [fill(word, words, f"{self.file}: finally {number}")]
            commands.append(command)
        return commands


def fill(text, words, where):
    """`text` with each {name} replaced by its word."""
    def replace(match):
        if match[1] not in words:
            raise CampaignError(f"{where}: {{{match[1]}}} is unknown (accepted: {', '.join(sorted(words))})")
        return str(words[match[1]])
    return re.sub(r"\{(\w+)\}", replace, text)


def read_campaign(file):
    try:
        with open(file, "rb") as stream:
            text = tomllib.load(stream)
    except OSError as error:
        raise CampaignError(f"{file}: {error.strerror}") from error
    except tomllib.TOMLDecodeError as error:
        raise CampaignError(f"{file}: is no TOML: {error}") from error
    return Campaign(text, os.path.dirname(os.path.abspath(file)), file)

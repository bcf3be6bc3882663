"""Numbers and words from the JSON files that the commands of a case write."""
import json
import re

STEP = re.compile(r"\.?([^.\[\]]+)|\[([^\]]*)\]")


def find_values(data, key):
    """{suffix: value} of a key such as `residual.fraction`, `parameters[name=1.z.stiffness].value`, `checks[0].max_percent` or,
    with a suffix for each entry of an array, `parameters[name=*].value`. What is not there is left out."""
    found = {"": data}
    for plain, chosen in STEP.findall(key):
        found = {suffix + more: value for suffix, here in found.items()
                 for more, value in (step_into(here, plain) if plain else choose(here, chosen))}
    return found


def step_into(here, name):
    return [("", here[name])] if isinstance(here, dict) and name in here else []


def choose(here, chosen):
    if not isinstance(here, list):
        return []
    name, equals, wanted = chosen.partition("=")
    if not equals:
        return [("", here[int(name)])] if name.lstrip("-").isdigit() and -len(here) <= int(name) < len(here) else []
    entries = [entry for entry in here if isinstance(entry, dict) and name in entry]
    if wanted == "*":
        return [("." + str(entry[name]), entry) for entry in entries]
    return [("", entry) for entry in entries if str(entry[name]) == wanted][:1]


def read_results(results, folder):
    """The columns that a case's files give. A number that is not there is left out, and becomes NaN in the table."""
    columns, files = {}, {}
    for result in results:
        name = result["file"]
        if name not in files:
            with open(f"{folder}/{name}", encoding="utf-8") as file:
                files[name] = json.load(file)
        for suffix, value in find_values(files[name], result["key"]).items():
            column = result["column"] + suffix
            if result.get("text"):
                columns[column] = value if isinstance(value, str) else json.dumps(value, sort_keys=True)
            elif isinstance(value, (int, float)):
                columns[column] = float(value)
    return columns
